// Looking for files.
#include "app/session.h"

#include <cstdlib>

#include "app/values.h"

namespace pse::app {

namespace fs = std::filesystem;

std::vector<fs::path> Session::search_path() const {
  std::vector<fs::path> folders;
  for (const OptionValue& folder : arguments.all("include")) folders.emplace_back(folder.text);
  if (const char* path = std::getenv("PSE_PATH"))
    for (const std::string& folder : split(path, ":")) folders.emplace_back(folder);
  folders.insert(folders.end(), configuration.path.begin(), configuration.path.end());
  return folders;
}

std::string Session::find_file(const std::string& name) const {
  std::error_code error;
  if (name == "-" || fs::path(name).is_absolute() || fs::exists(name, error)) return name;
  for (const fs::path& folder : search_path())
    if (fs::exists(folder / name, error)) return (folder / name).string();
  return name;
}

}  // namespace pse::app
