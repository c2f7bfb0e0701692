// The one table of commands and options. Parsing, --help, the man pages and the shell completions
// all read it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pse::app {

enum class Takes {
  nothing,   // a switch
  one,       // a value; the last one given counts
  many,      // a value each time it is given
  optional,  // a value behind `=`, or none
};

// What a shell should offer for a value.
enum class Offer { nothing, program, image, file, directory, knob };

struct OptionSpec {
  std::string_view letter;  // "o", or empty
  std::string_view name;    // "output"; the key in pse.toml as well
  Takes takes = Takes::nothing;
  std::string_view value;  // how the value is called in help: "FILE"
  std::string_view help;
  std::vector<std::string_view> choices = {};  // all values there are; empty: any
  Offer offer = Offer::nothing;
  std::string_view environment = {};  // the variable that sets it too
  std::vector<std::string_view> proposals = {};  // some of the values, where there are others too
};

struct CommandSpec {
  std::string_view name;
  std::string_view usage;        // what stands behind the name
  std::string_view summary;      // one line
  std::string_view description;  // paragraphs
  Offer offer = Offer::nothing;  // of the arguments
  std::vector<OptionSpec> options;
  std::vector<std::pair<std::string_view, std::string_view>> examples;  // command, what it does
};

// What shells propose for a value: its choices, or its proposals.
inline const std::vector<std::string_view>& proposed(const OptionSpec& option) {
  return option.choices.empty() ? option.proposals : option.choices;
}

std::span<const CommandSpec> commands();
const CommandSpec* find_command(std::string_view name);
const OptionSpec* find_option(const CommandSpec& command, std::string_view name);

// Exit statuses with their meanings, for help and man pages.
std::span<const std::pair<std::string_view, std::string_view>> exit_statuses();
// Environment variables with their meanings, besides those of options.
std::span<const std::pair<std::string_view, std::string_view>> environment_variables();

}  // namespace pse::app
