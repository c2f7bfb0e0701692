// Running the built `pse` and measuring it from outside.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace pse::bench {

struct Measured {
  int status = -1;
  double seconds = 0;
  double peak_mebibytes = 0;  // resident
};

// Starts pse with these arguments, its output thrown away; with a folder, there, and with its
// standard output in a pipe that is never read.
pid_t start_pse(const std::vector<std::string>& arguments,
                const std::filesystem::path& folder = {});
// The same, and waits for it.
Measured run_pse(const std::vector<std::string>& arguments);

}  // namespace pse::bench
