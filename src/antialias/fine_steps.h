// The looking for pixels that are coarser than what they show (find_fine_pixels() in tile.h), for
// the instructions that the including file is compiled for. As in neighbours.h nothing here may be
// kept out of line but what is local.
#pragma once

#include "antialias/fine.h"
#include "antialias/lanes.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

// What deviates by less from its mean is left to its neighbours (smooth.h); three samples in a row,
// of which neither tells of the others, bend by 6 times its square.
constexpr float least_deviation = 0.0175f;
constexpr float least_bend_squared = 6 * least_deviation * least_deviation;
// What deviates by more is grainy.
constexpr float most_deviation = 0.0225f;
constexpr float more_squared =
    (most_deviation / least_deviation) * (most_deviation / least_deviation);

template <std::size_t lanes>
std::size_t find_fine(const Tile& tile, Pixel* found) {
  using V = typename LanesOf<lanes>::Floats;
  using Answers = AnswersOf<V>;
  constexpr auto at_once = static_cast<std::ptrdiff_t>(lanes);
  const std::ptrdiff_t row = tile.area.width(), width = tile.rect.width();
  Pixel* next = found;
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
    for (std::ptrdiff_t i = 0; i < width; i += at_once) {
      const std::size_t at = tile.at(tile.rect.x0 + static_cast<int>(i), y);
      const V move = load<V>(tile.fine + at);
      Answers fine = move > least_move_squared;
      if (!any(fine)) continue;
      const float* path = tile.path() + at;
      const Answers way = load<Answers>(path);
      V bends{}, most{};
      for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, row - 1, row, row + 1}) {
        const Answers alike =
            (load<Answers>(path + step) == way) & (load<Answers>(path - step) == way);
        V bend{};
        for (std::size_t o = 0; o < tile.outputs; ++o) {
          const float* middle = tile.planes[o] + at;
          bend = larger(size(load<V>(middle + step) + load<V>(middle - step) - 2 * load<V>(middle)),
                        bend);
        }
        bends += choose(alike, bend * bend, V{});
        most += choose(alike, V{} + least_bend_squared, V{});
      }
      fine &= bends > most;
      const Answers grainy = (move > most_move_squared) & (bends > more_squared * most);
      const std::uint32_t grain = mask_of(grainy);
      const std::uint32_t wild = mask_of(grainy & (move > most_half_move_squared));
      std::uint32_t wanted = mask_of(fine);
      if (width - i < at_once) wanted &= (1u << (width - i)) - 1;
      for (; wanted != 0; wanted &= wanted - 1) {
        const int k = __builtin_ctz(wanted);
        *next++ = {.x = tile.rect.x0 + static_cast<int>(i) + k,
                   .y = y,
                   .grain = static_cast<Grain>((grain >> k & 1) + (wild >> k & 1))};
      }
    }
  return static_cast<std::size_t>(next - found);
}

}  // namespace
}  // namespace pse::antialias
