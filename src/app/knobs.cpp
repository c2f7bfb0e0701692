// Collecting knob settings and fitting them to the program's knobs.
#include "app/knobs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>

#include "app/help.h"
#include "app/text_file.h"
#include "app/toml_entries.h"
#include "app/values.h"
#include "lang/parser.h"
#include "lower/constant.h"

namespace pse::app {
namespace {

// PSE_ variables that mean something else; no knob is set by them.
bool is_reserved(std::string_view name) {
  for (const CommandSpec& command : commands())
    for (const OptionSpec& option : command.options)
      if (option.environment == fmt::format("PSE_{}", name)) return true;
  return name == "PATH";
}

void add_environment_settings(std::vector<KnobSetting>& settings) {
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::size_t equals = text.find('=');
    if (!text.starts_with("PSE_") || equals == std::string_view::npos) continue;
    const std::string name(text.substr(4, equals - 4));
    if (!is_reserved(name)) settings.push_back({name, std::string(text.substr(equals + 1)), ""});
  }
}

// "Name value" or "Name = value" lines, # comments.
void add_plain_lines(const std::string& file, const std::string& text,
                     std::vector<KnobSetting>& settings) {
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = std::string_view(text).substr(at, end - at);
    at = end + 1;
    ++number;
    if (const auto comment = line.find('#'); comment != std::string_view::npos)
      line = line.substr(0, comment);
    const auto trim = [](std::string_view part) {
      const auto first = part.find_first_not_of(" \t\r");
      return first == std::string_view::npos
                 ? std::string_view()
                 : part.substr(first, part.find_last_not_of(" \t\r") - first + 1);
    };
    line = trim(line);
    if (line.empty()) continue;
    const std::size_t name_end = std::min(line.find_first_of(" \t="), line.size());
    std::string_view value = trim(line.substr(name_end));
    if (value.starts_with('=')) value = trim(value.substr(1));
    if (value.empty() || name_end == 0)
      throw usage_error(fmt::format("{}:{}: a line is `Name value`, not `{}`", file, number, line));
    settings.push_back({std::string(line.substr(0, name_end)), std::string(value),
                        fmt::format("{}:{}", file, number)});
  }
}

void add_file_settings(const std::string& file, std::vector<KnobSetting>& settings) {
  const std::string text = read_text_file(file);
  if (!file.ends_with(".toml")) return add_plain_lines(file, text, settings);
  for (const TomlEntry& entry : read_toml(text, file)) {
    const std::string origin = fmt::format("{}:{}", file, entry.line);
    if (!entry.table.empty() && entry.table != "knobs") continue;
    const std::string value = entry.is_array ? fmt::format("[{}]", fmt::join(entry.elements, ", "))
                                             : entry.elements.front();
    settings.push_back({entry.key, value, origin});
  }
}

// The value of a text that should be numbers: an expression of the language, or plain numbers
// behind commas.
std::optional<std::vector<float>> numbers_of(const std::string& text) {
  SourceMap sources;
  Diagnostics diagnostics;
  const std::string wrapped =
      text.find(',') != std::string::npos && !text.starts_with('[') ? "[" + text + "]" : text;
  const lang::ExprPtr expr =
      lang::parse_expression(sources, sources.add("<value>", wrapped), diagnostics);
  if (!expr || diagnostics.has_errors()) return std::nullopt;
  const auto value = lower::constant_value(*expr);
  if (!value || value->is_text) return std::nullopt;
  return value->numbers;
}

std::string where(const KnobSetting& setting) {
  return setting.origin.empty() ? "PSE_" + setting.name : setting.origin;
}

std::string shape(const Knob& knob) {
  if (knob.is_text()) return "a text";
  if (knob.is_boolean) return "true or false";
  return knob.value.size() == 1 ? "a number"
                                : fmt::format("a vector of {} numbers", knob.value.size());
}

// "knob `Scale` takes a number, not `red` (--define)"
[[noreturn]] void refuse(const Knob& knob, const KnobSetting& setting) {
  throw usage_error(fmt::format("{}: knob `{}` takes {}, not `{}`", where(setting), knob.name,
                                shape(knob), setting.text),
                    fmt::format("for example: {}={}", knob.name, knob_text(knob)));
}

void check_range(const Knob& knob, const KnobSetting& setting, Console& console) {
  for (const float value : knob.value) {
    const bool below = knob.min && value < *knob.min, above = knob.max && value > *knob.max;
    if (below || above)
      console.warning("knob-range",
                      fmt::format("{}: {} = {} is {} its {} of {}", where(setting), knob.name,
                                  value, below ? "below" : "above", below ? "minimum" : "maximum",
                                  below ? *knob.min : *knob.max));
  }
}

void apply(Knob& knob, const KnobSetting& setting, Console& console) {
  if (!knob.options.empty() && knob.is_text() &&
      std::find(knob.options.begin(), knob.options.end(), setting.text) == knob.options.end())
    throw usage_error(fmt::format("{}: knob `{}` is one of {}, not `{}`", where(setting), knob.name,
                                  fmt::join(knob.options, ", "), setting.text));
  if (knob.is_text()) {
    knob.text = setting.text;
    return;
  }
  if (knob.is_boolean) {
    const std::string& text = setting.text;
    const bool yes = text == "true" || text == "1" || text == "yes" || text == "on";
    if (!yes && text != "false" && text != "0" && text != "no" && text != "off")
      refuse(knob, setting);
    knob.value = {yes ? 1.0f : 0.0f};
    return;
  }
  const auto numbers = numbers_of(setting.text);
  if (!numbers || (numbers->size() != knob.value.size() && numbers->size() != 1))
    refuse(knob, setting);
  // One number for a vector holds for all of its components.
  if (numbers->size() == 1)
    std::fill(knob.value.begin(), knob.value.end(), numbers->front());
  else
    knob.value = *numbers;
  check_range(knob, setting, console);
}

// The 2002 chapter's special parameters, which say how a program is run.
bool is_option_of_chapter(const std::string& name) {
  return name == "RES" || name == "CLIP" || name == "XFORM";
}

}  // namespace

std::vector<KnobSetting> knob_settings(const Session& session,
                                       const std::vector<std::string>& words) {
  std::vector<KnobSetting> settings;
  add_environment_settings(settings);
  for (const OptionValue& file : session.arguments.all("params"))
    add_file_settings(session.find_file(file.text), settings);

  const auto add_word = [&](const std::string& word, const std::string& origin) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      throw usage_error(fmt::format("{} takes Name=VALUE, not `{}`", origin, word));
    settings.push_back({word.substr(0, equals), word.substr(equals + 1), "the command line"});
  };
  for (const OptionValue& define : session.arguments.all("define")) add_word(define.text, "-D");
  for (const std::string& word : words) add_word(word, "a knob");
  return settings;
}

std::vector<Knob> apply_settings(std::vector<Knob> knobs, const std::vector<KnobSetting>& settings,
                                 Console& console) {
  for (const KnobSetting& setting : settings) {
    const auto knob = std::find_if(knobs.begin(), knobs.end(),
                                   [&](const Knob& k) { return k.name == setting.name; });
    if (knob != knobs.end()) {
      apply(*knob, setting, console);
    } else if (!setting.origin.empty()) {
      std::vector<std::string> names;
      for (const Knob& known : knobs) names.push_back(known.name);
      const std::string near = nearest_name(setting.name, names);
      throw usage_error(
          fmt::format("{}: the program has no knob `{}`", where(setting), setting.name),
          is_option_of_chapter(setting.name)
              ? fmt::format("it is no knob: `{0}=...` on the command line, or $PSE_{0}",
                            setting.name)
          : !near.empty() ? fmt::format("did you mean `{}`?", near)
          : names.empty() ? "it has no knobs"
                          : fmt::format("its knobs: {}", fmt::join(names, ", ")));
    }
  }
  return knobs;
}

void set_knob_uniforms(const ir::Module& module, const std::vector<Knob>& knobs,
                       FrameState& state) {
  for (const Knob& knob : knobs)
    for (std::size_t c = 0; c < knob.value.size(); ++c) {
      const std::string name =
          knob.value.size() == 1 ? knob.name : fmt::format("{}.{}", knob.name, c);
      for (std::size_t i = 0; i < module.inputs.size(); ++i)
        if (module.inputs[i].rate == ir::Rate::frame && module.inputs[i].name == name)
          state.uniforms[i] = knob.value[c];
    }
}

std::string knob_text(const Knob& knob) {
  if (knob.is_text()) return knob.text;
  if (knob.is_boolean) return knob.value.front() != 0 ? "true" : "false";
  if (knob.value.size() == 1) return fmt::format("{}", knob.value.front());
  return fmt::format("[{}]", fmt::join(knob.value, " "));
}

std::string knob_help(const std::vector<Knob>& knobs) {
  if (knobs.empty()) return "The program has no knobs.\n";
  std::size_t width = 0;
  std::vector<std::string> heads;
  for (const Knob& knob : knobs) {
    heads.push_back(fmt::format("{}={}", knob.name, knob_text(knob)));
    width = std::max(width, heads.back().size());
  }
  width = std::min<std::size_t>(width, 40);
  std::string out = "knobs, with the program's own values:\n";
  for (std::size_t i = 0; i < knobs.size(); ++i) {
    const Knob& knob = knobs[i];
    std::vector<std::string> notes;
    if (knob.min && knob.max) notes.push_back(fmt::format("{} to {}", *knob.min, *knob.max));
    if (knob.min && !knob.max) notes.push_back(fmt::format("at least {}", *knob.min));
    if (!knob.min && knob.max) notes.push_back(fmt::format("at most {}", *knob.max));
    if (!knob.options.empty()) notes.push_back(fmt::format("{}", fmt::join(knob.options, " | ")));
    if (!knob.units.empty()) notes.push_back("in " + knob.units);
    std::string text = knob.help.empty() ? knob.label : knob.help;
    if (!notes.empty())
      text += fmt::format("{}({})", text.empty() ? "" : " ", fmt::join(notes, ", "));
    std::string lines = wrap(text.empty() ? "." : text, width + 6);
    const std::string head = "  " + heads[i];
    if (head.size() + 2 <= width + 6)
      lines.replace(0, head.size(), head);
    else
      lines = head + "\n" + lines;
    if (text.empty()) lines = head + "\n";
    out += lines;
  }
  return out;
}

}  // namespace pse::app
