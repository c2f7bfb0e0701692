// Diagnostics for a person or an editor, as -W asks.
#pragma once

#include "app/session.h"
#include "diag/diagnostics.h"

namespace pse::app {

// What -W says. Throws Failure (usage) for an unknown word.
WarningPolicy warning_policy(const Arguments& arguments);

// The diagnostics that the policy shows, in order.
Diagnostics filtered(const Diagnostics& diagnostics, const WarningPolicy& policy);

// Prints those that the policy shows as text on standard error; returns them.
Diagnostics show(const Diagnostics& diagnostics, const SourceMap& sources, Console& console);
// Shows them on standard error. Throws Failure: `program` after errors, `strict` after
// warnings, these or any before, under -Werror.
void report(const Diagnostics& diagnostics, const SourceMap& sources, Session& session);
// What -Werror says at the end.
Failure strict_failure();
// How a command should end after these (already filtered) diagnostics.
Exit exit_of(const Diagnostics& diagnostics, const WarningPolicy& policy);

}  // namespace pse::app
