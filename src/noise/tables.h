// The constant tables of the noise family. Chapter, "Recent improvements to the noise function".
#pragma once

#include <array>
#include <span>

#include "noise/number.h"

namespace pse::num {

// The 2002 permutation of 0 to 255.
extern const ByteTable permutation;

// The gradients of the 2002 noise in 1 to 4 dimensions: one table for each component, of 16 (4-D:
// 32) entries.
std::span<const FloatTable> gradient_tables(std::size_t dimensions);

// The gradients of the 1989 noise: 256 directions uniform on the unit sphere of 2 to 4 dimensions,
// by the paper's Monte Carlo method (1989 paper, "noise", steps 1 to 3); in one dimension slopes
// uniform in [-1, 1].
std::span<const FloatTable> sphere_tables(std::size_t dimensions);

// The tables that the chapter's listing makes: its shuffled table, which is no permutation, and its
// gradients.
const ByteTable& book_permutation();
std::span<const FloatTable> book_gradients();

// Twenty-four consecutive bits of 2/pi from each bit on: entry i starts at bit i - two_over_pi_lead
// behind the point (the first is bit 1), and bits before the first are 0. For the reduction of
// large angles.
inline constexpr int two_over_pi_lead = 32;
extern const IntTable two_over_pi;

// For logarithms of m in [0.708, 1.416], by eighths of that octave: a factor c of few bits that
// brings m near 1, and -log2(c) in two parts, the first a multiple of 2^-16.
extern const FloatTable octave_factor, octave_log2, octave_log2_rest;

}  // namespace pse::num
