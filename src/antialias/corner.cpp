// Counting places, and fitting the counts to what is known exactly.
#include "antialias/corner.h"

#include <algorithm>
#include <cmath>

#include "antialias/lanes.h"

namespace pse::antialias {
namespace {

// Edges bend a little: nearer than this to a line, in pixels, a sample may be on either side.
constexpr float margin = 0.04f;

Four distance(const Line& line, const Offsets& offsets, std::size_t k) {
  return line.distance +
         (line.nx * load<Four>(&offsets.x[k]) + line.ny * load<Four>(&offsets.y[k]));
}

// Regions are numbered by the sides of the first and of the second line.
constexpr std::size_t of_sides(bool first, bool second) {
  return (first ? 1u : 0u) | (second ? 2u : 0u);
}

}  // namespace

Corner::Regions Corner::regions(const Offsets& offsets) const {
  std::uint32_t on_first = 0, on_second = 0, unsure = 0;
  for (std::size_t k = 0; k < offsets.size(); k += four) {
    const Four first = distance(lines_.first, offsets, k);
    const Four second = distance(lines_.second, offsets, k);
    on_first |= mask_of(first > 0) << k, on_second |= mask_of(second > 0) << k;
    unsure |= mask_of(smaller(size(first), size(second)) < margin) << k;
  }
  Regions found;
  const std::uint32_t all = ~0u >> (32 - offsets.size());
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      const std::uint32_t in = (first ? on_first : ~on_first) & (second ? on_second : ~on_second);
      found.sure[of_sides(first, second)] = in & ~unsure & all;
      found.unsure[of_sides(first, second)] = in & unsure & all;
    }
  return found;
}

std::array<float, 4> Corner::weights(const Filter& filter, const Offsets& offsets) const {
  // Places in each region.
  AnswersOf<Four> of_first{}, of_second{}, of_both{};
  const std::size_t whole = offsets.size() / four * four;
  for (std::size_t k = 0; k < whole; k += four) {
    const auto a = distance(lines_.first, offsets, k) > 0;
    const auto b = distance(lines_.second, offsets, k) > 0;
    of_first -= a, of_second -= b, of_both -= a & b;
  }
  const auto sum = [](const AnswersOf<Four>& of) { return of[0] + of[1] + of[2] + of[3]; };
  const std::int32_t first = sum(of_first), second = sum(of_second), both = sum(of_both);
  const auto count = static_cast<std::int32_t>(whole);
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
