// What a circle holds of a kernel: for edges that bend within the kernel's reach, where a straight
// edge with a correction is not near enough. 2002 chapter, "The High-Contrast Filter", has straight
// edges only.
//
// Of a round kernel the share is the mean, over the angle in which the circle is seen from the
// kernel's middle, of the mass nearer than the circle. What of the circle is beyond the kernel's
// reach has all mass nearer; the rest is a smooth integral over the angle at the circle's middle.
#include <algorithm>
#include <cmath>

#include "antialias/filter.h"
#include "noise/math.h"

namespace pse::antialias {
namespace {

// Gauss and Legendre's twelve places z of [0, 1] as z (2 - z), and their weights: a root at the far
// end of the integral becomes smooth.
constexpr std::array<std::array<float, 2>, 12> nodes = {{{0.0183543632f, 0.0467403947f},
                                                         {0.0935843685f, 0.101812508f},
                                                         {0.216861131f, 0.141661531f},
                                                         {0.370105428f, 0.161245652f},
                                                         {0.532259248f, 0.159689223f},
                                                         {0.683462444f, 0.14017429f},
                                                         {0.808695853f, 0.108972756f},
                                                         {0.900090747f, 0.0738033134f},
                                                         {0.957423382f, 0.0419217746f},
                                                         {0.986763805f, 0.0184167977f},
                                                         {0.997701625f, 0.00512681799f},
                                                         {0.999914997f, 0.000434941641f}}};

float root_above_0(float a) { return std::sqrt(std::max(a, 0.0f)); }
float arc_of(float cosine) { return num::acos(std::clamp(cosine, -1.0f, 1.0f)); }

}  // namespace

// The kernel's mass nearer than r, over the square of r; scale 1.
float Filter::mass_per_square(float square) const {
  switch (kind_) {
    case FilterKind::cubic: {
      const float w = root_above_0(1 - 4 * square);
      return square < 0.25f ? 4 * (1 + w + w * w) / (1 + w) : 1 / square;
    }
    case FilterKind::disc:
      return 1;
    case FilterKind::cone:
      return 3 - 2 * root_above_0(square);
    case FilterKind::paraboloid:
      return 2 - square;
    default:
      return square < 1e-3f ? 2 - 2 * square : (1 - num::exp(-2 * square)) / square;
  }
}

Filter::Within Filter::within(float x, float y, float radius) const {
  const float r = radius / scale_, reach = this->reach() / scale_;
  const float a = std::sqrt(x * x + y * y) / scale_;
  if (!(r > 0) || a >= r + reach) return {0, 0, 0};
  if (a + reach <= r) return {1, 0, 0};
  if (kind_ == FilterKind::box) return box_within(x, y, radius);

  // Angles at the circle's middle, from the place nearest to the kernel's middle.
  const float both = a * r;
  const float end = both < 1e-9f ? num::pi : arc_of((a * a + r * r - reach * reach) / (2 * both));
  const float beyond = end < num::pi ? arc_of((a - r * num::cos(end)) / reach) : 0;
  float share = 0, moment = 0;
  for (const auto& [place, weight] : nodes) {
    const float cosine = num::cos(end * place);
    const float square = std::max(a * a + r * r - 2 * both * cosine, 0.0f);
    const float per_square = mass_per_square(square);
    share += weight * per_square * (r * r - both * cosine);
    moment += weight * (1 - square * per_square) * r * cosine;
  }
  share = std::clamp((beyond + end * share) / num::pi, 0.0f, 1.0f);
  moment = a < 1e-6f ? 0 : end * moment / num::pi / a;
  return {share, moment * x, moment * y};
}

// By columns: the circle and the square bound them from below and above, each for some columns.
Filter::Within Filter::box_within(float at_x, float at_y, float radius) const {
  const float x = at_x / scale_, y = at_y / scale_, r = radius / scale_;
  // Columns t from the circle's middle, and where the circle meets the square's sides.
  const float low = std::max(-0.5f - x, -r), high = std::min(0.5f - x, r);
  const float top = root_above_0(r * r - (0.5f - y) * (0.5f - y));
  const float bottom = root_above_0(r * r - (0.5f + y) * (0.5f + y));
  std::array<float, 6> ends = {low, -top, top, -bottom, bottom, high};
  for (float& end : ends) end = std::clamp(end, low, std::max(low, high));
  std::ranges::sort(ends);

  Within sum{0, 0, 0};
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const float from = ends[k], to = ends[k + 1];
    if (!(from < to)) continue;
    const float t = (from + to) / 2, middle = root_above_0(r * r - t * t);
    // Each bound is a side of the square, or the circle's middle and its height.
    const bool is_cut_above = y + middle > 0.5f, is_cut_below = y - middle < -0.5f;
    const float above = is_cut_above ? 0.5f : y, below = is_cut_below ? -0.5f : y;
    const float up = is_cut_above ? 0 : 1, down = is_cut_below ? 0 : -1;
    if (above + up * middle <= below + down * middle) continue;
    // The integrals of the height, of t times it, and of its square.
    const float s = root_above_0(r * r - from * from), e = root_above_0(r * r - to * to);
    const float height =
        (to * e - from * s + r * r * (num::atan2(to, e) - num::atan2(from, s))) / 2;
    const float of_t = (s * s * s - e * e * e) / 3;
    const float square = r * r * (to - from) - (to * to * to - from * from * from) / 3;
    const float width = to - from, area = (above - below) * width + (up - down) * height;
    sum.share += area;
    sum.x += x * area + (above - below) * (to * to - from * from) / 2 + (up - down) * of_t;
    sum.y += ((above * above - below * below) * width + 2 * (above * up - below * down) * height +
              (up * up - down * down) * square) /
             2;
  }
  return {std::clamp(sum.share, 0.0f, 1.0f), sum.x * scale_, sum.y * scale_};
}

}  // namespace pse::antialias
