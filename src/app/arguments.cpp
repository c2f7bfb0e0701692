// CLI11 driven by the table. It takes words apart; values are only checked where they are used.
#include "app/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/failure.h"
#include "diag/diagnostics.h"

namespace pse::app {
namespace {

// The names of a command's options as typed, for suggestions.
std::vector<std::string> typed_names(const CommandSpec& command) {
  std::vector<std::string> names;
  for (const OptionSpec& option : command.options)
    names.push_back(fmt::format("--{}", option.name));
  return names;
}

[[noreturn]] void unknown_option(const CommandSpec& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const std::string near =
      name.starts_with("--") ? nearest_name(name, typed_names(command)) : std::string();
  throw usage_error(fmt::format("there is no option `{}`", name),
                    near.empty() ? fmt::format("`pse {} --help` lists the options", command.name)
                                 : fmt::format("did you mean `{}`?", near));
}

// CLI11's names of an option: "-o,--output".
std::string cli_names(const OptionSpec& option) {
  return option.letter.empty() ? fmt::format("--{}", option.name)
                               : fmt::format("-{},--{}", option.letter, option.name);
}

}  // namespace

std::optional<OptionValue> Arguments::value(std::string_view name) const {
  const auto found = options.find(name);
  if (found == options.end() || found->second.empty()) return std::nullopt;
  return found->second.back();
}

std::string Arguments::text_or(std::string_view name, std::string_view otherwise) const {
  const auto found = value(name);
  return found ? found->text : std::string(otherwise);
}

std::vector<OptionValue> Arguments::all(std::string_view name) const {
  const auto found = options.find(name);
  return found == options.end() ? std::vector<OptionValue>() : found->second;
}

Arguments parse_arguments(const CommandSpec& command, const std::vector<std::string>& words) {
  // Describe the options to CLI11.
  Arguments result;
  result.command = &command;
  CLI::App parser;
  parser.set_help_flag();
  parser.allow_extras();
  std::map<std::string, std::vector<std::string>> values;
  std::map<std::string, CLI::Option*> known;
  for (const OptionSpec& option : command.options) {
    const std::string name(option.name);
    if (option.takes == Takes::nothing)
      known[name] = parser.add_flag(cli_names(option));
    else if (option.takes == Takes::optional)
      known[name] = parser.add_flag(fmt::format("--{}{{{}}}", option.name, option.choices.front()),
                                    values[name]);
    else
      known[name] =
          parser.add_option(cli_names(option), values[name])->allow_extra_args(false)->take_all();
  }

  // Parse. CLI11 wants the words in reverse order.
  try {
    parser.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    throw usage_error(error.what(),
                      fmt::format("`pse {} --help` explains the options", command.name));
  }
  bool options_end = false;
  for (const std::string& word : parser.remaining()) {
    if (word == "--" && !options_end) {
      options_end = true;
      continue;
    }
    if (!options_end && word.size() > 1 && word.front() == '-') unknown_option(command, word);
    result.positionals.push_back(word);
  }

  // Keep what was given.
  for (const auto& [name, option] : known) {
    if (option->count() == 0) continue;
    const std::string origin = fmt::format("--{}", name);
    std::vector<OptionValue>& to = result.options[name];
    for (const std::string& text : values[name]) to.push_back({text, origin});
    if (to.empty()) to.push_back({"true", origin});
  }
  return result;
}

void add_environment(Arguments& arguments, Lookup variable) {
  for (const OptionSpec& option : arguments.command->options) {
    if (option.environment.empty() || arguments.has(option.name)) continue;
    const std::string name(option.environment);
    if (const auto text = variable(name); text && !text->empty())
      arguments.options[std::string(option.name)] = {{*text, name}};
  }
}

void check_choices(const Arguments& arguments) {
  for (const OptionSpec& option : arguments.command->options) {
    if (option.choices.empty()) continue;
    for (const OptionValue& given : arguments.all(option.name)) {
      if (std::find(option.choices.begin(), option.choices.end(), given.text) !=
          option.choices.end())
        continue;
      const std::string near =
          nearest_name(given.text, {option.choices.begin(), option.choices.end()});
      throw usage_error(fmt::format("{} takes {}, not `{}`", given.origin,
                                    fmt::join(option.choices, ", "), given.text),
                        near.empty() ? "" : fmt::format("did you mean `{}`?", near));
    }
  }
}

}  // namespace pse::app
