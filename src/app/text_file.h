// Texts from files and standard input.
#pragma once

#include <string>

namespace pse::app {

// The whole file, or standard input for "-". Throws Failure (input) with the reason. Refuses what
// is larger than any text pse takes.
std::string read_text_file(const std::string& path);

}  // namespace pse::app
