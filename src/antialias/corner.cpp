// Counting places, and fitting the counts to what is known exactly.
#include "antialias/corner.h"

#include <algorithm>
#include <cmath>

namespace pse::antialias {
namespace {

// Edges bend a little: nearer than this to a line, in pixels, a sample may be on either side.
constexpr float margin = 0.04f;

float distance(const Line& line, float x, float y) {
  return line.distance + (line.nx * x + line.ny * y);
}

// Regions are numbered by the sides of the first and of the second line.
constexpr std::size_t of_sides(bool first, bool second) {
  return (first ? 1u : 0u) | (second ? 2u : 0u);
}

}  // namespace

std::uint8_t Corner::region(float x, float y) const {
  const float first = distance(lines_.first, x, y), second = distance(lines_.second, x, y);
  const bool is_unsure = std::min(std::abs(first), std::abs(second)) < margin;
  return static_cast<std::uint8_t>(of_sides(first > 0, second > 0) | (is_unsure ? unsure : 0u));
}

std::array<float, 4> Corner::weights(const Filter& filter, const Offsets& offsets) const {
  // Places in each region.
  std::int32_t first = 0, second = 0, both = 0;
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const float x = offsets.x[k], y = offsets.y[k];
    const std::int32_t a = distance(lines_.first, x, y) > 0 ? 1 : 0;
    const std::int32_t b = distance(lines_.second, x, y) > 0 ? 1 : 0;
    first += a, second += b, both += a & b;
  }
  const auto count = static_cast<std::int32_t>(offsets.size());
  std::array<float, 4> weights{};
  weights[of_sides(true, true)] = static_cast<float>(both);
  weights[of_sides(true, false)] = static_cast<float>(first - both);
  weights[of_sides(false, true)] = static_cast<float>(second - both);
  weights[of_sides(false, false)] = static_cast<float>(count - first - second + both);
  // A region between two places is not overlooked.
  for (float& weight : weights) weight = std::max(weight, 0.5f) / static_cast<float>(count);

  // The shares of both lines are exact: scale rows and columns of the table to them in turn.
  const float on_first = filter.share(lines_.first.distance, lines_.first.nx, lines_.first.ny);
  const float on_second = filter.share(lines_.second.distance, lines_.second.nx, lines_.second.ny);
  constexpr int rounds = 3;
  for (int round = 0; round < rounds; ++round)
    for (const bool is_first : {true, false})
      for (const bool side : {true, false}) {
        float& a = weights[is_first ? of_sides(side, false) : of_sides(false, side)];
        float& b = weights[is_first ? of_sides(side, true) : of_sides(true, side)];
        const float share = is_first ? on_first : on_second;
        const float factor = (side ? share : 1 - share) / std::max(a + b, 1e-6f);
        a *= factor, b *= factor;
      }
  return weights;
}

}  // namespace pse::antialias
