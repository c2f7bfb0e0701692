// The option table as text for a terminal.
#pragma once

#include <string>

#include "app/option_table.h"

namespace pse::app {

// `pse --help`: the commands.
std::string overview_help();
// `pse COMMAND --help`.
std::string command_help(const CommandSpec& command);

// "-o, --output FILE"
std::string option_heading(const OptionSpec& option);
// Text broken into lines of at most `width` columns, each behind `indent` spaces; keeps blank
// lines.
std::string wrap(std::string_view text, std::size_t indent, std::size_t width = 100);

}  // namespace pse::app
