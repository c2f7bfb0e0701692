// Diagnostics for a person or an editor, as -W asks.
#pragma once

#include "app/session.h"
#include "diag/diagnostics.h"

namespace pse::app {

// -W: which warnings to show, and whether they count as errors.
struct WarningPolicy {
  bool hide_all = false;
  bool are_errors = false;
  std::vector<std::string> hidden;  // codes
};
WarningPolicy warning_policy(const Arguments& arguments);

// The diagnostics that the policy shows, in order.
Diagnostics filtered(const Diagnostics& diagnostics, const WarningPolicy& policy);

// Prints them as text on standard error. Throws Failure: `program` after errors, `strict` after
// warnings under -Werror.
void report(const Diagnostics& diagnostics, const SourceMap& sources, Session& session);
// How a command should end after these (already filtered) diagnostics.
Exit exit_of(const Diagnostics& diagnostics, const WarningPolicy& policy);

}  // namespace pse::app
