// The smoothing of a tile's pixels (smooth.h) while its rows are moved together, for the
// instructions that the including file is compiled for. As in neighbours.h nothing here may be kept
// out of line but what is local.
#pragma once

#include "antialias/lanes.h"
#include "antialias/neighbours.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

// Rows and what is left of them are read before they are written over.
template <std::size_t lanes>
void smooth(const Tile& tile, const Smoothing& by, std::span<float* const> planes) {
  using V = typename LanesOf<lanes>::Floats;
  using Answers = AnswersOf<V>;
  constexpr auto at_once = static_cast<std::ptrdiff_t>(lanes);
  constexpr float huge = 3e38f;
  const std::ptrdiff_t row = tile.area.width(), width = tile.rect.width();
  const float *path = tile.path(), *ends = tile.ends();
  const std::ptrdiff_t steps[] = {1, row, row - 1, row + 1};
  std::ptrdiff_t to = 0;
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y, to += width) {
    const auto first = static_cast<std::ptrdiff_t>(tile.at(tile.rect.x0, y));
    for (std::ptrdiff_t i = 0; i < width; i += at_once) {
      const std::ptrdiff_t at = first + i;
      // Opposite neighbours that both go the pixel's way.
      Answers alike[] = {Answers{} - 1, Answers{} - 1, Answers{} - 1, Answers{} - 1};
      for (std::size_t k = 0; k < 4 && path != nullptr; ++k) {
        const Answers way = load<Answers>(path + at);
        alike[k] = (load<Answers>(path + at + steps[k]) == way) &
                   (load<Answers>(path + at - steps[k]) == way);
        if (ends == nullptr) continue;
        const V end = load<V>(ends + at);
        alike[k] &= (size(load<V>(ends + at + steps[k]) - end) <= least_end) &
                    (size(load<V>(ends + at - steps[k]) - end) <= least_end);
      }
      for (float* const plane : planes) {
        const float* const from = plane + at;
        const V middle = load<V>(from), twice = 2 * middle;
        V bends[4];
        for (std::size_t k = 0; k < 4; ++k)
          bends[k] =
              choose(alike[k], load<V>(from + steps[k]) + load<V>(from - steps[k]) - twice, V{});
        const V straight = by.axis * (bends[0] + bends[1]), most = size(straight);
        const V slanting = by.diagonal * (bends[2] + bends[3]);
        // Of waves the second is always the less. What it alone tells of, a bright dot at a corner,
        // would take light away.
        const V more = straight + larger(-most, smaller(most, slanting));
        // What is no finite number tells nothing.
        const V mean = choose(size(more) < huge, middle + more, middle);
        if (width - i >= at_once)
          store(plane + to + i, mean);
        else
          std::memcpy(plane + to + i, &mean, static_cast<std::size_t>(width - i) * sizeof(float));
      }
    }
  }
}

}  // namespace
}  // namespace pse::antialias
