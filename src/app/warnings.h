// What -W asks of warnings. The console has it, through which every warning goes.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace pse::app {

// Which warnings to show, and whether they count as errors.
struct WarningPolicy {
  bool hide_all = false;
  bool are_errors = false;
  std::vector<std::string> hidden;  // codes

  bool shows(std::string_view code) const {
    return !hide_all && std::find(hidden.begin(), hidden.end(), code) == hidden.end();
  }
};

}  // namespace pse::app
