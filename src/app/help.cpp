// Laying the option table out in columns.
#include "app/help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/version.h"

namespace pse::app {

std::string wrap(std::string_view text, std::size_t indent, std::size_t width) {
  std::string out;
  while (!text.empty()) {
    std::string_view paragraph = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), paragraph.size() + 1));
    std::string line(indent, ' ');
    bool empty = true;
    while (!paragraph.empty()) {
      const std::string_view word = paragraph.substr(0, paragraph.find(' '));
      paragraph.remove_prefix(std::min(paragraph.size(), word.size() + 1));
      if (!empty && line.size() + 1 + word.size() > width) {
        out += line + "\n";
        line.assign(indent, ' ');
        empty = true;
      }
      if (!empty) line += ' ';
      line += word;
      empty = false;
    }
    out += empty ? "\n" : line + "\n";
  }
  return out;
}

std::string option_heading(const OptionSpec& option) {
  std::string heading = option.letter.empty() ? "" : fmt::format("-{}, ", option.letter);
  heading += fmt::format("--{}", option.name);
  if (option.takes == Takes::optional) return heading + fmt::format("[={}]", option.value);
  if (option.takes != Takes::nothing) heading += fmt::format(" {}", option.value);
  return heading;
}

std::string overview_help() {
  std::string out =
      fmt::format("pse {}: a pixel stream editor\n\nusage: pse COMMAND ...\n\n", version);
  for (const CommandSpec& command : commands())
    out += fmt::format("  {:<12}{}\n", command.name, command.summary);
  out +=
      "\n`pse COMMAND --help` explains a command, `pse render PROGRAM --help` a program's knobs.\n";
  return out;
}

std::string command_help(const CommandSpec& command) {
  std::string out = fmt::format("pse {}: {}\n\nusage: pse {} {}\n\n", command.name, command.summary,
                                command.name, command.usage);
  out += wrap(command.description, 0);
  out += "\noptions:\n";
  constexpr std::size_t column = 30;
  for (const OptionSpec& option : command.options) {
    std::string help(option.help);
    if (!option.choices.empty()) help += fmt::format(" ({})", fmt::join(option.choices, ", "));
    if (!option.environment.empty()) help += fmt::format(" [${}]", option.environment);
    const std::string heading = (option.letter.empty() ? "      " : "  ") + option_heading(option);
    std::string text = wrap(help, column);
    if (heading.size() + 2 <= column)
      text.replace(0, heading.size(), heading);
    else
      text = heading + "\n" + text;
    out += text;
  }
  if (!command.examples.empty()) out += "\nexamples:\n";
  for (const auto& [line, meaning] : command.examples)
    out += meaning.empty() ? fmt::format("  {}\n", line)
                           : fmt::format("  {}\n      {}\n", line, meaning);
  return out;
}

}  // namespace pse::app
