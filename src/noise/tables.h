// The constant tables of the noise family. Chapter, "Recent improvements to the noise function".
#pragma once

#include <array>
#include <span>

#include "noise/number.h"

namespace pse::num {

// The 2002 permutation of 0 to 255.
extern const ByteTable permutation;

// The gradients of the 2002 noise in 1 to 4 dimensions: one table for each component, of 16 (4-D: 32) entries.
std::span<const FloatTable> gradient_tables(std::size_t dimensions);

}  // namespace pse::num
