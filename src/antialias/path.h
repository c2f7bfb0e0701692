// Which way through the program each sample takes, as one more output. Neighbouring samples with
// different paths have an edge between them (2002 chapter: "at neighbouring samples the procedure
// follows different paths at conditional statements").
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

inline constexpr const char* path_name = "$path";
// What tells neighbours apart where loops turn differently often from sample to sample.
inline constexpr const char* way_name = "$way";
inline constexpr const char* ends_name = "$ends";

// Adds the output "$path" to a module fresh from the lowering: a whole number from 0 to 2^24 - 1
// that hashes the outcomes of all jumps and the turns of all loops. Where there are loops that
// turn differently often from sample to sample, such as those that march along rays, two more:
// "$way", which counts of such loops but the last turn, and "$ends", a sum of what they end with,
// each by the logarithm of its size, which jumps where one of them does. The other outputs keep
// their bits. Gives how many outputs it has added.
std::size_t add_path(ir::Module& module, const Decisions& decisions);

// Whether anything in the module can fail.
bool has_checks(const ir::Module& module);
// Removes the checks: for samples that the user has not asked for.
void remove_checks(ir::Module& module);

}  // namespace pse::antialias
