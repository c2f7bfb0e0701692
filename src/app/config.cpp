// Finding and applying pse.toml.
#include "app/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/failure.h"
#include "app/text_file.h"
#include "app/toml_entries.h"
#include "diag/diagnostics.h"

namespace pse::app {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> configuration_files() {
  std::vector<fs::path> candidates;
  std::error_code error;
  for (fs::path folder = fs::current_path(error); !folder.empty(); folder = folder.parent_path()) {
    candidates.push_back(folder / "pse.toml");
    if (folder == folder.root_path()) break;
  }
  const char* config_home = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  if (config_home != nullptr && *config_home != 0)
    candidates.push_back(fs::path(config_home) / "pse/pse.toml");
  else if (home != nullptr && *home != 0)
    candidates.push_back(fs::path(home) / ".config/pse/pse.toml");
  candidates.emplace_back("/etc/pse/pse.toml");

  std::vector<fs::path> found;
  for (const fs::path& candidate : candidates)
    if (fs::is_regular_file(candidate, error)) found.push_back(candidate);
  return found;
}

bool some_command_has(const std::string& option) {
  for (const CommandSpec& command : commands())
    if (find_option(command, option) != nullptr) return true;
  return false;
}

void warn_unknown(const TomlEntry& entry, const std::string& name,
                  std::vector<std::string>& unknown) {
  std::vector<std::string> names = {"path"};
  for (const CommandSpec& command : commands())
    for (const OptionSpec& option : command.options)
      if (entry.table.empty() || entry.table == command.name) names.emplace_back(option.name);
  const std::string near = nearest_name(entry.key, names);
  unknown.push_back(fmt::format("{}:{}: there is no option `{}`{}", name, entry.line, entry.key,
                              near.empty() ? "" : fmt::format("; did you mean `{}`?", near)));
}

// Whether the entry is of use to this command; warns where it is of use to none.
const OptionSpec* option_of(const TomlEntry& entry, const CommandSpec& command,
                            const std::string& name,
                  std::vector<std::string>& unknown) {
  if (!entry.table.empty() && find_command(entry.table) == nullptr) {
    unknown.push_back(
        fmt::format("{}:{}: there is no command `{}`", name, entry.line, entry.table));
    return nullptr;
  }
  const bool known = entry.table.empty()
                         ? some_command_has(entry.key)
                         : find_option(*find_command(entry.table), entry.key) != nullptr;
  if (!known) warn_unknown(entry, name, unknown);
  return entry.table.empty() || entry.table == command.name ? find_option(command, entry.key)
                                                            : nullptr;
}

std::string joined(const std::vector<std::string>& elements) {
  std::string text;
  for (const std::string& element : elements) text += (text.empty() ? "" : ",") + element;
  return text;
}

}  // namespace

Configuration add_configuration(Arguments& arguments) {
  Configuration configuration;
  configuration.files = configuration_files();
  for (const fs::path& file : configuration.files) {
    const std::string name = file.string();
    std::vector<TomlEntry> entries = read_toml(read_text_file(name), name);
    // A command's own table goes before what holds for all.
    std::stable_sort(entries.begin(), entries.end(), [](const TomlEntry& a, const TomlEntry& b) {
      return !a.table.empty() && b.table.empty();
    });
    for (const TomlEntry& entry : entries) {
      if (entry.table.empty() && entry.key == "path") {
        for (const std::string& folder : entry.elements)
          configuration.path.push_back(file.parent_path() / folder);
        continue;
      }
      const OptionSpec* option = option_of(entry, *arguments.command, name, configuration.unknown);
      if (option == nullptr || arguments.has(option->name)) continue;
      std::vector<OptionValue>& values = arguments.options[entry.key];
      const std::string origin = fmt::format("{}:{}: {}", name, entry.line, entry.key);
      if (option->takes == Takes::nothing) {
        if (!entry.is_boolean) throw usage_error(fmt::format("{} takes true or false", origin));
        if (entry.elements.front() == "true") values.push_back({"true", origin});
        if (values.empty()) arguments.options.erase(entry.key);
      } else if (option->takes == Takes::many) {
        for (const std::string& element : entry.elements) values.push_back({element, origin});
      } else {
        values.push_back({joined(entry.elements), origin});
      }
    }
  }
  return configuration;
}

}  // namespace pse::app
