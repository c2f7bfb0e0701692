// Nothing: what is compiled with this file are the precompiled headers (pse_targets.cmake).
