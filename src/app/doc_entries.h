// Entries of `pse doc`.
#pragma once

#include <span>
#include <string>

namespace pse::app {

struct DocEntry {
  std::string name, signature, text;
  std::string home;  // "builtin, noise", "library/turbulence.pse", "variable"
};

// The variables, the constants and the functions that depend on shapes.
std::span<const DocEntry> told_entries();

}  // namespace pse::app
