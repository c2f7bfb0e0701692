// A program on its way into the compiler: its text, and the host's answers to what its lowering
// asks.
#pragma once

#include "app/session.h"
#include "lower/lower.h"

namespace pse::app {

struct ProgramFile {
  SourceMap sources;
  FileId file = no_file;
  std::string path;  // as found; "-" for standard input

  const std::string& text() const { return sources.file(file).text; }
};

// Throws Failure (input).
ProgramFile read_program(const std::string& name, const Session& session);

// Modules are looked for beside the program, then on the session's search path.
LowerHost module_host(const std::string& program_path, const Session& session);

// What a program says about itself. `images` are the names that images at hand bring; where there
// are none, names that look like channels of images count as brought. Errors and warnings go to
// `diagnostics`.
Lowered survey(ProgramFile& program, const LowerHost& host, Diagnostics& diagnostics,
               const std::vector<StreamName>& images = {});

}  // namespace pse::app
