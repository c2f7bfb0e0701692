// Completion scripts. Each shell gets the commands, their options, the choices of a value, and
// files of the right kind; a program's knobs are asked from its `--help`.
#include "app/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/option_table.h"

namespace pse::app {
namespace {

constexpr std::string_view image_patterns = "exr|png|jpg|jpeg|tif|tiff|hdr|dpx|mp4";

std::vector<std::string> names_of_commands() {
  std::vector<std::string> names;
  for (const CommandSpec& command : commands()) names.emplace_back(command.name);
  return names;
}

bool takes_value(const OptionSpec& option) {
  return option.takes == Takes::one || option.takes == Takes::many;
}

// ---- bash ----

std::string bash_offer(Offer offer) {
  switch (offer) {
    case Offer::program:
      return fmt::format("compgen -f -X '!*.@(pse|{})' -- \"$word\"; compgen -d -- \"$word\"",
                         image_patterns);
    case Offer::image:
      return fmt::format("compgen -f -X '!*.@({})' -- \"$word\"; compgen -d -- \"$word\"",
                         image_patterns);
    case Offer::directory:
      return "compgen -d -- \"$word\"";
    case Offer::file:
      return "compgen -f -- \"$word\"";
    case Offer::knob:
      return "_pse_knobs";
    case Offer::nothing:
      break;
  }
  return ":";
}

std::string bash_script() {
  std::string out = R"BASH(# bash completion of pse; made by `pse completion bash`
_pse_knobs() {
  local i
  for i in "${words[@]:2}"; do
    [[ $i == *.pse && -f $i ]] || continue
    compgen -W "$(pse render "$i" --help 2>/dev/null |
      sed -n 's/^  \([A-Z][A-Za-z0-9_]*=\).*/\1/p')" -- "$word"
  done
}
_pse() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words=("${COMP_WORDS[@]}")
  local restore; restore=$(shopt -p extglob); shopt -s extglob
  local IFS=$'\n'
)BASH";
  out += fmt::format(
      "  if [[ $COMP_CWORD == 1 ]]; then\n    COMPREPLY=($(compgen -W $'{}\\n--version\\n--help' "
      "-- \"$word\"))\n    eval \"$restore\"\n    return\n  fi\n",
      fmt::join(names_of_commands(), "\\n"));
  out += "  case ${COMP_WORDS[1]} in\n";
  for (const CommandSpec& command : commands()) {
    out += fmt::format("  {})\n    case $before in\n", command.name);
    std::string names;
    for (const OptionSpec& option : command.options) {
      names += fmt::format("{}--{}", names.empty() ? "" : "\\n", option.name);
      if (!option.letter.empty()) names += fmt::format("\\n-{}", option.letter);
      if (!takes_value(option)) continue;
      const std::string letter = option.letter.empty() ? "" : fmt::format("|-{}", option.letter);
      const std::string reply =
          proposed(option).empty()
              ? bash_offer(option.offer)
              : fmt::format("compgen -W $'{}' -- \"$word\"", fmt::join(proposed(option), "\\n"));
      out += fmt::format("    --{}{}) COMPREPLY=($({})); eval \"$restore\"; return ;;\n",
                         option.name, letter, reply);
    }
    out += "    esac\n";
    const std::string arguments =
        command.name == "completion" ? "compgen -W $'bash\\nzsh\\nfish' -- \"$word\""
        : command.name == "help"
            ? fmt::format("compgen -W $'{}' -- \"$word\"", fmt::join(names_of_commands(), "\\n"))
        : command.name == "doc" ? "compgen -W \"$(pse doc --list 2>/dev/null)\" -- \"$word\""
                                : bash_offer(command.offer);
    out += fmt::format(
        "    if [[ $word == -* ]]; then COMPREPLY=($(compgen -W $'{}' -- \"$word\"))\n", names);
    out += fmt::format("    else COMPREPLY=($({}{})); fi ;;\n", arguments,
                       command.name == "render" ? "; _pse_knobs" : "");
  }
  out += "  esac\n  eval \"$restore\"\n}\ncomplete -o filenames -o nospace -F _pse pse\n";
  return out;
}

// ---- zsh ----

// Text inside an option's brackets.
std::string zsh_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  }
  return out;
}

std::string zsh_offer(const OptionSpec& option) {
  if (!proposed(option).empty()) return fmt::format("({})", fmt::join(proposed(option), " "));
  switch (option.offer) {
    case Offer::directory:
      return "_files -/";
    case Offer::image:
      return fmt::format("_files -g \"*.({})\"", image_patterns);
    case Offer::program:
    case Offer::file:
      return "_files";
    default:
      return " ";
  }
}

std::string zsh_script() {
  std::string out =
      "#compdef pse\n# zsh completion of pse; made by `pse completion zsh`\n_pse() {\n  local -a "
      "names\n  names=(\n";
  for (const CommandSpec& command : commands())
    out += fmt::format("    '{}:{}'\n", command.name, zsh_text(command.summary));
  out +=
      "  )\n  if (( CURRENT == 2 )); then\n    _describe command names\n    return\n  fi\n  case "
      "$words[2] in\n";
  for (const CommandSpec& command : commands()) {
    out += fmt::format("  {})\n    shift words; (( CURRENT-- ))\n    _arguments -s", command.name);
    for (const OptionSpec& option : command.options) {
      const std::string value =
          takes_value(option) ? fmt::format(":{}:{}", zsh_text(option.value), zsh_offer(option))
                              : "";
      const std::string many = option.takes == Takes::many ? "*" : "";
      out +=
          fmt::format(" \\\n      '{}--{}[{}]{}'", many, option.name, zsh_text(option.help), value);
      if (!option.letter.empty())
        out += fmt::format(" \\\n      '{}-{}[{}]{}'", many, option.letter, zsh_text(option.help),
                           value);
    }
    const std::string arguments = command.name == "completion" ? "(bash zsh fish)"
                                  : command.name == "help"
                                      ? fmt::format("({})", fmt::join(names_of_commands(), " "))
                                  : command.offer == Offer::nothing ? " "
                                                                    : "_files";
    out += fmt::format(" \\\n      '*:argument:{}' ;;\n", arguments);
  }
  return out + "  esac\n}\n_pse \"$@\"\n";
}

// ---- fish ----

std::string fish_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string fish_script() {
  std::string out = "# fish completion of pse; made by `pse completion fish`\ncomplete -c pse -f\n";
  const std::string all = fmt::format("{}", fmt::join(names_of_commands(), " "));
  for (const CommandSpec& command : commands()) {
    out += fmt::format("complete -c pse -n 'not __fish_seen_subcommand_from {}' -a {} -d '{}'\n",
                       all, command.name, fish_text(command.summary));
    const std::string here =
        fmt::format("complete -c pse -n '__fish_seen_subcommand_from {}'", command.name);
    if (command.offer != Offer::nothing) out += here + " -F\n";
    if (command.name == "completion") out += here + " -a 'bash zsh fish'\n";
    if (command.name == "help") out += fmt::format("{} -a '{}'\n", here, all);
    if (command.name == "doc") out += here + " -a '(pse doc --list 2>/dev/null)'\n";
    for (const OptionSpec& option : command.options) {
      out += fmt::format("{} -l {}", here, option.name);
      if (!option.letter.empty()) out += fmt::format(" -s {}", option.letter);
      if (takes_value(option))
        out += option.offer == Offer::nothing || !proposed(option).empty() ? " -x" : " -r";
      if (!proposed(option).empty())
        out += fmt::format(" -a '{}'", fmt::join(proposed(option), " "));
      out += fmt::format(" -d '{}'\n", fish_text(option.help));
    }
  }
  return out;
}

}  // namespace

std::string completion_script(std::string_view shell) {
  if (shell == "bash") return bash_script();
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_script();
  return {};
}

}  // namespace pse::app
