// What every command that runs programs asks of the compiler.
#pragma once

#include "app/knobs.h"
#include "app/render_options.h"
#include "stream/program.h"

namespace pse::app {

// Code generation as the options ask for it, and the texts of string knobs. The names of the stream
// and the outputs wanted are the caller's.
CompileOptions compile_settings(const RenderOptions& options,
                                const std::vector<KnobSetting>& settings);

}  // namespace pse::app
