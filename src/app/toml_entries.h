// TOML files as a flat list of entries: what pse.toml and --params need of the format.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pse::app {

struct TomlEntry {
  std::string table;  // "render" of [render]; empty at the top
  std::string key;
  std::vector<std::string> elements;  // the values of an array, else one
  bool is_array = false;
  bool is_boolean = false;
  bool is_text = false;  // a string, or an array of strings
  int line = 0;
};

// Throws Failure (usage) with file and line where the text is not TOML, or nests deeper than one
// table.
std::vector<TomlEntry> read_toml(std::string_view text, const std::string& name);

}  // namespace pse::app
