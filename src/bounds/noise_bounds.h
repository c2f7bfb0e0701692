// How far noise can move within a box. Its second derivative is bounded, whatever the gradients at
// the lattice points, so from the value and the gradient in the middle of a small box follows what
// it can be at any place of it; a large box has the bounds of the whole noise.
//
// The constants were found on grids over the cell with the gradients of every corner free, each the
// worst of its table (tests/bounds/noise_bounds_test.cpp repeats it), and are 5 to 10 % wider than
// found. The noises of 1985 and 1989 have bounds by hand: an axis contributes at most 1/2 to the
// mean distance from the corners, and to their mean square distance 1/4.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "bounds/interval.h"
#include "noise/improved.h"

namespace pse::bounds {

// Of the 2002 noise in N dimensions: how far it is from 0; the same for each component of its
// gradient; and how far it can be from its tangent at distance 1 along every axis, which grows with
// the square.
struct NoiseLimits {
  float value, slope, bend;
};
inline constexpr std::array<NoiseLimits, 4> improved_limits = {
    {{0.95f, 2.7f, 7.7f}, {1.0f, 3.1f, 14.0f}, {1.04f, 4.0f, 24.0f}, {1.6f, 6.0f, 45.0f}}};

// By hand: a value in [-1, 1] and slopes in [-1, 1] at each corner.
inline float limit_1985(std::size_t dimensions) {
  return 1.0f + 0.5f * static_cast<float>(dimensions) + 1e-4f;
}
// By hand: slopes of length 1 at each corner.
inline float limit_1989(std::size_t dimensions) {
  return 0.5f * std::sqrt(static_cast<float>(dimensions)) + 1e-4f;
}

// The middle of a box and how far it reaches from there.
template <class F, std::size_t N>
struct Box {
  std::array<F, N> middle, reach;
  F farthest;  // of the reaches
};
template <class F, std::size_t N>
Box<F, N> box_of(const std::array<Interval<F>, N>& p) {
  Box<F, N> box;
  for (std::size_t axis = 0; axis < N; ++axis) {
    const F middle = fma(p[axis].lo, F(0.5f), p[axis].hi * 0.5f);
    const F reach = max(p[axis].hi - middle, middle - p[axis].lo) * (1.0f + 0x1p-20f);
    box.middle[axis] = middle;
    box.reach[axis] = reach;
    box.farthest = axis == 0 ? reach : max(box.farthest, reach);
  }
  return box;
}

// What a noise with this value and gradient in the middle of a box can be in it.
template <class F, std::size_t N>
Interval<F> around_middle(const num::Dual<F, N>& middle, const Box<F, N>& box,
                          const NoiseLimits& limits) {
  const std::array<F, N> slope = num::gradient(middle);
  // Noise itself is computed to a few ulps of 1.
  F reach = fma(box.farthest * box.farthest, F(limits.bend), F(1e-5f));
  for (std::size_t axis = 0; axis < N; ++axis)
    reach = fma(abs(slope[axis]), box.reach[axis], reach);
  return {max(middle.value - reach, F(-limits.value)), min(middle.value + reach, F(limits.value))};
}

// The bounds of `noise` in a box, where `noise` gives the values and gradients of Count noises at a
// place. Boxes so large that the tangent tells nothing are not asked.
template <std::size_t Count, class F, std::size_t N, class Noise>
std::array<Interval<F>, Count> bound_noise(const std::array<Interval<F>, N>& p,
                                           const Noise& noise) {
  const NoiseLimits& limits = improved_limits[N - 1];
  const Box<F, N> box = box_of(p);
  const float useful = std::sqrt(1.5f * limits.value / limits.bend);
  const auto ends = choose<2 * Count>(
      box.farthest < F(useful),
      [&] {
        std::array<F, 2 * Count> near;
        std::array<num::Dual<F, N>, N> place = num::variables(box.middle);
        const std::array<num::Dual<F, N>, Count> middle = noise(place);
        for (std::size_t i = 0; i < Count; ++i) {
          const Interval<F> range = around_middle(middle[i], box, limits);
          near[2 * i] = range.lo;
          near[2 * i + 1] = range.hi;
        }
        return near;
      },
      [&] {
        std::array<F, 2 * Count> all;
        for (std::size_t i = 0; i < Count; ++i) {
          all[2 * i] = F(-limits.value);
          all[2 * i + 1] = F(limits.value);
        }
        return all;
      });
  // At infinity noise is NaN.
  const auto finite = box.farthest < F(num::infinity);
  std::array<Interval<F>, Count> result;
  for (std::size_t i = 0; i < Count; ++i)
    result[i] = provided(finite, Interval<F>{ends[2 * i], ends[2 * i + 1]});
  return result;
}

}  // namespace pse::bounds
