// Filtering and printing diagnostics.
#include "app/report.h"

#include <fmt/format.h>

#include <algorithm>

namespace pse::app {

WarningPolicy warning_policy(const Arguments& arguments) {
  WarningPolicy policy;
  for (const OptionValue& value : arguments.all("warn")) {
    if (value.text == "error")
      policy.are_errors = true;
    else if (value.text == "no-error")
      policy.are_errors = false;
    else if (value.text == "none")
      policy.hide_all = true;
    else if (value.text == "all")
      policy.hide_all = false;
    else if (value.text.starts_with("no-"))
      policy.hidden.push_back(value.text.substr(3));
    else
      throw usage_error(fmt::format("-W takes error, none, all or no-NAME, not `{}`", value.text));
  }
  return policy;
}

Diagnostics filtered(const Diagnostics& diagnostics, const WarningPolicy& policy) {
  Diagnostics shown;
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    if (diagnostic.severity == Severity::error || policy.shows(diagnostic.code))
      shown.add(diagnostic);
  }
  shown.sort();
  return shown;
}

Exit exit_of(const Diagnostics& diagnostics, const WarningPolicy& policy) {
  // A picture or volume that cannot be read is no fault of the program that names it.
  const auto is_input = [](const Diagnostic& d) {
    return d.code == "texture" || d.code == "volume";
  };
  const auto is_program = [&](const Diagnostic& d) {
    return d.severity == Severity::error && !is_input(d);
  };
  if (std::any_of(diagnostics.all().begin(), diagnostics.all().end(), is_program))
    return Exit::program;
  if (diagnostics.has_errors()) return Exit::input;
  const bool warned =
      std::any_of(diagnostics.all().begin(), diagnostics.all().end(),
                  [](const Diagnostic& d) { return d.severity == Severity::warning; });
  return warned && policy.are_errors ? Exit::strict : Exit::ok;
}

Diagnostics show(const Diagnostics& diagnostics, const SourceMap& sources, Console& console) {
  Diagnostics shown = filtered(diagnostics, console.warnings());
  console.raw_error(print_text(shown, sources, console.colour()));
  for (const Diagnostic& diagnostic : shown.all())
    if (diagnostic.severity == Severity::warning) console.count_warning();
  return shown;
}

Failure strict_failure() {
  return Failure(Exit::strict, "there are warnings, and -Werror makes them errors");
}

void report(const Diagnostics& diagnostics, const SourceMap& sources, Session& session) {
  Console& console = session.console;
  const Exit exit = exit_of(show(diagnostics, sources, console), console.warnings());
  if (exit != Exit::ok && exit != Exit::strict) throw Failure(exit, "");
  if (console.strict_failure()) throw strict_failure();
}

}  // namespace pse::app
