// Which way through the program each sample takes, as one more output. Neighbouring samples with
// different paths have an edge between them (2002 chapter: "at neighbouring samples the procedure
// follows different paths at conditional statements").
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

inline constexpr const char* path_name = "$path";

// Adds the output "$path" to a module fresh from the lowering: a whole number from 0 to 2^24 - 1
// that hashes the outcomes of all jumps and the turns of all loops. The other outputs keep their
// bits.
void add_path(ir::Module& module, const Decisions& decisions);

// Whether anything in the module can fail.
bool has_checks(const ir::Module& module);
// Removes the checks: for samples that the user has not asked for.
void remove_checks(ir::Module& module);

}  // namespace pse::antialias
