// A command line as the table understands it: each option's values with where they came from.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/option_table.h"

namespace pse::app {

struct OptionValue {
  std::string text;
  std::string origin;  // for messages: "--res", "PSE_RES", "pse.toml"
};

class Arguments {
 public:
  const CommandSpec* command = nullptr;
  std::vector<std::string> positionals;
  std::map<std::string, std::vector<OptionValue>, std::less<>> options;  // by long name

  bool has(std::string_view name) const { return options.contains(name); }
  // The value that counts.
  std::optional<OptionValue> value(std::string_view name) const;
  std::string text_or(std::string_view name, std::string_view otherwise) const;
  std::vector<OptionValue> all(std::string_view name) const;
};

// Parses what follows the command's name. Throws Failure (usage) for anything the table does not
// know.
Arguments parse_arguments(const CommandSpec& command, const std::vector<std::string>& words);

// Adds what the environment and then the configuration files set and the command line did not.
using Lookup = std::optional<std::string> (*)(const std::string& name);
void add_environment(Arguments& arguments, Lookup variable);

// Throws Failure (usage) unless the value is among the option's choices.
void check_choices(const Arguments& arguments);

}  // namespace pse::app
