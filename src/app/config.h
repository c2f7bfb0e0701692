// Configuration files: pse.toml here and in the folders above, then in XDG_CONFIG_HOME, then in
// /etc. The nearer file wins.
#pragma once

#include <filesystem>
#include <vector>

#include "app/arguments.h"
#include "app/console.h"

namespace pse::app {

struct Configuration {
  std::vector<std::filesystem::path> files;  // those found, nearest first
  std::vector<std::filesystem::path> path;   // their `path` lists: folders of modules and images
};

// Gives the command's options the files' values where the command line and the environment said
// nothing. Keys that no command knows are warned of. Throws Failure (usage) for a broken file.
Configuration add_configuration(Arguments& arguments, Console& console);

}  // namespace pse::app
