// The noise of 1985 in one to four dimensions. 1985 paper, "Noise()": every lattice point has a
// value and a gradient, a linear equation; between lattice points these equations are interpolated,
// by the cubic curve, in x, then y, then z. Unlike the later ones it is not 0 at lattice points.
// The hash mixes 32-bit lattice coordinates, so nothing repeats within 2^32 cells unless a period
// is asked for.
#pragma once

#include <array>
#include <cstddef>

#include "noise/lattice.h"
#include "noise/seed.h"

namespace pse::num {

// Two 32-bit numbers for each axis: one to mix its lattice coordinate in, one to draw its component
// of the gradient.
inline constexpr std::array<std::uint32_t, 4> lattice_factors = {0x8da6b343u, 0xd8163841u,
                                                                 0xcb1ab31fu, 0x165667b1u};
inline constexpr std::array<std::uint32_t, 4> gradient_factors = {0x9e3779b1u, 0x85ebca77u,
                                                                  0xc2b2ae3du, 0x27d4eb2fu};

// A number in [-1, 1] from 32 bits.
template <class F>
F unit_from_bits(const IntOf<F>& h) {
  return to_float(h) * 0x1p-31f;
}

// The noise at a point, found within [-1.6, 1.6]; at a lattice point its value there, even in [-1,
// 1]. A period is any whole number up to 2^20 here, and 0 or less means that.
template <class F, std::size_t N>
F noise_1985(const std::array<F, N>& point, const NoiseOptions<BaseOf<F>, N>& options = {}) {
  using B = BaseOf<F>;
  using I = IntOf<B>;
  const Cell<F, N> cell = cell_of(point);

  // The lattice coordinates of the corners, each scattered by its axis.
  std::array<std::array<I, 2>, N> mixed;
  for (std::size_t axis = 0; axis < N; ++axis) {
    const I low = to_int(cell.corner[axis]);
    std::array<I, 2> ends = {low, low + I(1)};
    if (options.period) ends = wrap(cell.corner[axis], (*options.period)[axis], 0x1p20f);
    for (std::size_t end = 0; end < 2; ++end)
      mixed[axis][end] = ends[end] * I(word(lattice_factors[axis]));
  }

  return interpolate<F, N>(cubic_fades(cell), [&](std::size_t c, const F* start) {
    // The paper's [a, b, c, d] = H([x, y, z]).
    I h = options.key ? *options.key ^ I(0x5bd1e995) : I(0x5bd1e995);
    for (std::size_t axis = 0; axis < N; ++axis) h = h ^ mixed[axis][(c >> axis) & 1];
    h = scatter(h);
    const F value(unit_from_bits<B>(h));
    F sum = start ? value + *start : value;
    for (std::size_t axis = 0; axis < N; ++axis) {
      const F slope(unit_from_bits<B>(h * I(word(gradient_factors[axis]))));
      sum = fma(slope, cell.offset[(c >> axis) & 1][axis], sum);
    }
    return sum;
  });
}

}  // namespace pse::num
