// Which way through the program each sample takes, as one more output. Neighbouring samples with
// different paths have an edge between them (2002 chapter: "at neighbouring samples the procedure
// follows different paths at conditional statements").
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

inline constexpr const char* path_name = "$path";
inline constexpr const char* ends_name = "$ends";
inline constexpr const char* fine_name = "$fine";
inline constexpr const char* bent_name = "$bent";
// The lower bits of a path, which tell of jumps alone.
inline constexpr int bits_of_jumps = 10;
// Of these the three lowest count jumps, the next three those of creases.
inline constexpr int one_crease = 8, bits_of_counts = 6;

// Of the kernels that end within a pixel.
inline constexpr float usual_reach = 0.75f;

// Adds the output "$path" to a module fresh from the lowering: a whole number from 0 to 2^24 - 1
// that hashes the outcomes of all jumps and the turns of all loops; of loops that search, the
// outcomes of the last turn. Where there are such loops, adds "$ends" too: a sum of what they end
// with, each by the logarithm of its size, which jumps where one of them does. Where there is noise
// that may be finer than a pixel, adds "$fine": how far such noise's place moves from pixel to
// pixel (move_squared()). Where there are jumps that no pixel's middle may show, adds "$bent" last:
// not 0 where one of them is within `reach` pixels (bent.h).
// The other outputs keep their bits.
void add_path(ir::Module& module, const Decisions& decisions, float reach = usual_reach);

// Whether anything in the module can fail.
bool has_checks(const ir::Module& module);
// Removes the checks and expectations: for samples that the user has not asked for.
void remove_checks(ir::Module& module);

}  // namespace pse::antialias
