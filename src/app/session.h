// What every command is given: its arguments, the console, and where files are looked for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/arguments.h"
#include "app/config.h"
#include "app/console.h"
#include "app/failure.h"

namespace pse::app {

struct Session {
  Arguments arguments;
  Configuration configuration;
  Console& console;

  // Where modules and images are looked for after the program's own folder: -I, PSE_PATH, pse.toml.
  std::vector<std::filesystem::path> search_path() const;
  // The file itself where it exists or is "-", else the first of that name on the search path, else
  // the name unchanged.
  std::string find_file(const std::string& name) const;
};

// One function per command. They return the exit status, or throw Failure.
Exit render_command(Session& session);
Exit bake_command(Session& session);
Exit check_command(Session& session);
Exit fmt_command(Session& session);
Exit info_command(Session& session);
Exit doc_command(Session& session);
Exit diff_command(Session& session);

// The whole command line; `words` without the program's name.
int run_command_line(const std::vector<std::string>& words, Console& console);

}  // namespace pse::app
