// --emit: the printable form of each stage of the compiler.
#pragma once

#include <string>

#include "app/program_file.h"
#include "stream/program.h"

namespace pse::app {

// The text of a stage; throws Failure. Errors of the program go to `diagnostics`, the text is then
// empty.
std::string emit_stage(const std::string& stage, ProgramFile& program, const LowerHost& host,
                       const CompileOptions& options, Diagnostics& diagnostics);

}  // namespace pse::app
