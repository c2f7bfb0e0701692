// Running the built `pse` and measuring it from outside.
#pragma once

#include <string>
#include <vector>

namespace pse::bench {

struct Measured {
  int status = -1;
  double seconds = 0;
  double peak_mebibytes = 0;  // resident
};

// Runs pse with these arguments, its output thrown away, and waits for it.
Measured run_pse(const std::vector<std::string>& arguments);

}  // namespace pse::bench
