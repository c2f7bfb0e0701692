// The 2002 noise in one to four dimensions, one body for all. Chapter, "Recent improvements to the
// noise function"; in three dimensions these are the numbers of the published reference
// implementation, to rounding.
#pragma once

#include <array>
#include <cstddef>

#include "noise/lattice.h"
#include "noise/tables.h"

namespace pse::num {

// One octave of gradient noise whose corner hashes are known.
template <class F, std::size_t N>
F improved_from(const Cell<F, N>& cell, const std::array<F, N>& fade,
                const CornerHashes<BaseOf<F>, N>& hashes) {
  const auto tables = gradient_tables(N);
  return interpolate<F, N>(fade, [&](std::size_t c, const F* start) {
    const auto index = corner_hash(hashes, c);
    std::array<BaseOf<F>, N> corner_gradient;
    for (std::size_t axis = 0; axis < N; ++axis)
      corner_gradient[axis] = lookup(tables[axis], index);
    return slope_at(cell, c, corner_gradient, start);
  });
}

// The signed noise at a point; 0 wherever all coordinates are whole.
template <class F, std::size_t N>
F improved_noise(const std::array<F, N>& point, const NoiseOptions<BaseOf<F>, N>& options = {}) {
  const Cell<F, N> cell = cell_of(point);
  return improved_from(cell, quintic_fades(cell), hash_corners(cell.corner, options));
}

// Three such noises at once that have nothing to do with each other; the first is improved_noise.
template <class F, std::size_t N>
std::array<F, 3> improved_vector_noise(const std::array<F, N>& point,
                                       const NoiseOptions<BaseOf<F>, N>& options = {}) {
  const Cell<F, N> cell = cell_of(point);
  const std::array<F, N> fade = quintic_fades(cell);
  const auto hashes = hash_corners(cell.corner, options);
  // The masks are those of the 256 that leave the gradients at a lattice point least correlated, at
  // most 0.12.
  const auto remixed = [&hashes](std::int32_t mask) {
    auto mixed = hashes;
    for (auto& word : mixed) word = lookup(permutation, word ^ IntOf<BaseOf<F>>(mask));
    return mixed;
  };
  return {improved_from(cell, fade, hashes), improved_from(cell, fade, remixed(0x16161616)),
          improved_from(cell, fade, remixed(0x32323232))};
}

}  // namespace pse::num
