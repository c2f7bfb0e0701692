// A shared library needs one file of its own; what libpse holds is src/api and src/noise.
