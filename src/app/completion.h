// The option table as completion scripts of shells.
#pragma once

#include <string>
#include <string_view>

namespace pse::app {

// The script for "bash", "zsh" or "fish"; empty for any other shell.
std::string completion_script(std::string_view shell);

}  // namespace pse::app
