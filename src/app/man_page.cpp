// Writes roff. Everything printed comes from the option table.
#include "app/man_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/version.h"

namespace pse::app {
namespace {

// Text in which roff sees no commands of its own.
std::string escaped(std::string_view text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    line_start = c == '\n';
  }
  return out;
}

std::string paragraphs(std::string_view text) {
  std::string out = escaped(text) + "\n";
  for (std::size_t at = 0; (at = out.find("\n\n", at)) != std::string::npos; at += 5)
    out.replace(at, 2, "\n.PP\n");
  return out;
}

std::string heading(const std::string& title, const std::string& date) {
  return fmt::format(".TH {} 1 \"{}\" \"pse {}\" \"User Commands\"\n", title, date, version);
}

std::string term(std::string_view name, std::string_view meaning) {
  return fmt::format(".TP\n.B {}\n{}\n", escaped(name), escaped(meaning));
}

std::string common_sections() {
  std::string out = ".SH EXIT STATUS\n";
  for (const auto& [status, meaning] : exit_statuses()) out += term(status, meaning);
  out += ".SH ENVIRONMENT\n";
  for (const auto& [name, meaning] : environment_variables()) out += term(name, meaning);
  out += ".SH FILES\n" +
         term("pse.toml",
              "values of options by their long names, at the top for all commands or in a "
              "table named after one; read here and in the folders above, then in "
              "XDG_CONFIG_HOME/pse, then in /etc/pse");
  return out;
}

}  // namespace

std::string man_page(const CommandSpec& command, const std::string& date) {
  std::string out = heading(fmt::format("PSE\\-{}", command.name), date);
  out += fmt::format(".SH NAME\npse\\-{} \\- {}\n", command.name, escaped(command.summary));
  out += fmt::format(".SH SYNOPSIS\n.B pse {}\n{}\n", command.name, escaped(command.usage));
  out += ".SH DESCRIPTION\n" + paragraphs(command.description);

  out += ".SH OPTIONS\n";
  for (const OptionSpec& option : command.options) {
    std::string names = option.letter.empty() ? "" : fmt::format("\\-{}, ", option.letter);
    names += escaped(fmt::format("--{}", option.name));
    std::string value;
    if (option.takes == Takes::optional) value = fmt::format("[={}]", option.value);
    if (option.takes == Takes::one || option.takes == Takes::many)
      value = fmt::format(" {}", option.value);
    std::string text = escaped(option.help);
    if (!option.choices.empty())
      text += escaped(fmt::format(" ({})", fmt::join(option.choices, ", ")));
    if (!option.environment.empty())
      text += fmt::format("\nAlso set by the variable {}.", option.environment);
    out += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", names,
                       value.empty() ? "" : "\\fI" + escaped(value) + "\\fR", text);
  }
  if (!command.examples.empty()) out += ".SH EXAMPLES\n";
  for (const auto& [line, meaning] : command.examples) out += term(line, meaning);
  return out + common_sections();
}

std::string overview_man_page(const std::string& date) {
  std::string out = heading("PSE", date);
  out += ".SH NAME\npse \\- a pixel stream editor\n.SH SYNOPSIS\n.B pse\nCOMMAND ...\n";
  out += ".SH DESCRIPTION\nRuns a program at every pixel of a picture.\n.SH COMMANDS\n";
  for (const CommandSpec& command : commands())
    out += term(fmt::format("pse-{}(1)", command.name), command.summary);
  return out + common_sections();
}

}  // namespace pse::app
