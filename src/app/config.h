// Configuration files: pse.toml here and in the folders above, then in XDG_CONFIG_HOME, then in
// /etc. The nearer file wins.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/arguments.h"

namespace pse::app {

struct Configuration {
  std::vector<std::filesystem::path> files;  // those found, nearest first
  std::vector<std::filesystem::path> path;   // their `path` lists: folders of modules and images
  std::vector<std::string> unknown;          // a line for each key that is of use to nobody
};

// Gives the command's options the files' values where the command line and the environment said
// nothing. The files may set -W too, so what to warn of is only
// collected. Throws Failure (usage) for a broken file.
Configuration add_configuration(Arguments& arguments);

}  // namespace pse::app
