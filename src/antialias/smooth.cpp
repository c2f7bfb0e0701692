// The answer of the nine samples to the wave (s, t), in radians per pixel, is
//
//   1 + 2 axis (cos s + cos t - 2) + 4 diagonal (cos s cos t - 1)
//
// and the kernel's, its transform, begins with 1 - v / 2 (s^2 + t^2) + m / 24 (s^4 + t^4) +
// c / 4 s^2 t^2, where v is its variance, m and c its fourth moments. Terms of second order agree
// when axis + 2 diagonal = v / 2. Those of fourth order cannot agree in all directions, for the
// part with s^4 + t^4 depends on that sum alone: too much by e = v / 24 - m / 24. The diagonal
// makes up for it by a part with s^2 t^2, and the mean square over all directions is least where
// that is -10 / 3 e.
#include "antialias/smooth.h"

#include <algorithm>

namespace pse::antialias {

Smoothing smoothing_of(const Filter& filter) {
  constexpr float most_variance = 0.25f;
  const auto [along, across] = filter.fourth_moments();
  const float narrower = std::min(1.0f, most_variance / filter.variance());
  const float variance = filter.variance() * narrower, fourth = narrower * narrower;
  const float excess = (variance - fourth * along) / 24;
  const float diagonal = fourth * across / 4 - 10.0f / 3 * excess;
  return {variance / 2 - 2 * diagonal, diagonal};
}

}  // namespace pse::antialias
