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
    const bool hidden = std::find(policy.hidden.begin(), policy.hidden.end(), diagnostic.code) !=
                        policy.hidden.end();
    if (diagnostic.severity == Severity::error || !(policy.hide_all || hidden))
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

void report(const Diagnostics& diagnostics, const SourceMap& sources, Session& session) {
  const WarningPolicy policy = warning_policy(session.arguments);
  const Diagnostics shown = filtered(diagnostics, policy);
  session.console.raw_error(print_text(shown, sources, session.console.colour()));
  const Exit exit = exit_of(shown, policy);
  if (exit == Exit::strict)
    throw Failure(exit, "there are warnings, and -Werror makes them errors");
  if (exit != Exit::ok) throw Failure(exit, "");
}

}  // namespace pse::app
