// The exact response of the chapter's kernel to a disc, for the tests that hold pictures against it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pse::antialias::test {

// The share of the cubic kernel inside a disc whose centre is `a` pixels away, by rings of equal
// weight around the pixel's centre: one of radius r has the angle 2 acos(..) inside.
inline double share_of_disc(double a, double radius) {
  constexpr int rings = 3000;
  if (a > radius + 0.5) return 0;
  if (a + 0.5 < radius) return 1;
  double share = 0;
  for (int i = 0; i < rings; ++i) {
    const double u = (i + 0.5) / rings, r = 0.5 * std::sqrt(1 - std::pow(1 - u, 2.0 / 3));
    if (a + r <= radius)
      share += 1;
    else if (std::abs(a - r) < radius)
      share += std::acos(std::clamp((a * a + r * r - radius * radius) / (2 * a * r), -1.0, 1.0)) /
               std::numbers::pi;
  }
  return share / rings;
}

}  // namespace pse::antialias::test
