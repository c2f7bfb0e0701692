// The program with its conditions laid open (2002 chapter, "More Detailed Description"): what each
// compares comes out beside the pixel's values, and either way can be taken at will. For samples
// that are known at pixels only, where the edges' slopes are fitted to neighbours (stored.h).
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

inline constexpr const char* force_high_name = "$high";
inline constexpr const char* force_low_name = "$low";
inline constexpr const char* condition_name = "$condition";  // and its number, from 0
inline constexpr const char* step_suffix = "s";              // behind that, if it is a step

// Masks of conditions travel as floats, which hold whole numbers of 24 bits.
inline constexpr std::size_t most_conditions = 24;

// Adds to a module, as it comes from the lowering, for each of the first 24 comparisons and steps
// outside of loops an output: the value that is above 0 where the comparison holds, NaN where the
// program does not come by; of a step (floor and the like) the value that it steps at whole numbers
// of. Where bit k of the input "$high" is set, condition k holds, or the step nearest to the value
// is taken; where bit k of "$low" is set, it does not hold, or that step is not taken yet.
void open_conditions(ir::Module& module);

}  // namespace pse::antialias
