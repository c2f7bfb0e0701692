// The standard library: programs of library/, kept inside the executable and found by the names of
// their functions.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pse {

struct LibraryFile {
  std::string_view name;  // "turbulence", of library/turbulence.pse
  std::string_view text;
};

std::span<const LibraryFile> library_files();

// The names of the functions that a text defines at its outermost level: lines that start with
// `function `.
std::vector<std::string> functions_defined_in(std::string_view text);

}  // namespace pse
