// The noise of 1989 in one to four dimensions. 1989 paper, "noise": a knot at every lattice point,
// a linear function with a pseudorandom gradient, weighted by omega(t) = 2 |t|^3 - 3 |t|^2 + 1
// along each axis, the nearest 2^N knots summed. The weights of a cell's corners along an axis add
// up to 1, so the sum is an interpolation by 3 t^2 - 2 t^3.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "noise/lattice.h"
#include "noise/tables.h"

namespace pse::num {

// The noise at a point, found within [-0.8, 0.8]; 0 wherever all coordinates are whole. Period 256.
template <class F, std::size_t N>
F noise_1989(const std::array<F, N>& point, const NoiseOptions<BaseOf<F>, N>& options = {}) {
  using B = BaseOf<F>;
  // The paper's phi(i + phi(j + phi(k))) folds the last coordinate first: take the axes in the
  // other order.
  std::array<F, N> turned = point;
  std::ranges::reverse(turned);
  NoiseOptions<B, N> turned_options = options;
  if (turned_options.period) std::ranges::reverse(*turned_options.period);

  const Cell<F, N> cell = cell_of(turned);
  const auto hashes = hash_corners(cell.corner, turned_options);
  const auto tables = sphere_tables(N);
  return interpolate<F, N>(cubic_fades(cell), [&](std::size_t c, const F* start) {
    const auto index = corner_hash(hashes, c);
    std::array<B, N> knot_gradient;
    for (std::size_t axis = 0; axis < N; ++axis)
      knot_gradient[axis] = lookup(tables[N - 1 - axis], index);
    return slope_at(cell, c, knot_gradient, start);
  });
}

}  // namespace pse::num
