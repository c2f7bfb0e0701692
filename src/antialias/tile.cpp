// The memory for comparing neighbours, and the looking for what is finer than they are.
#include "antialias/tile.h"

#include "antialias/fine.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

// What bends by less is so near to its mean that samples change nothing that can be seen.
constexpr float least_fine_bend = 0.02f;

}  // namespace

int apron_of(const Filter& filter) { return filter.reach() > 1.01f ? 2 : 1; }

std::span<const Pixel> find_edge_pixels(const Tile& tile, const Filter& filter, Found& found) {
  const auto samples = static_cast<std::size_t>(tile.area.width()) *
                       static_cast<std::size_t>(tile.area.height() + 1);
  const auto pixels =
      static_cast<std::size_t>(tile.rect.width()) * static_cast<std::size_t>(tile.rect.height());
  const auto grow = [](auto& list, std::size_t size) {
    if (list.size() < size) list.resize(size);
  };
  grow(found.changes, samples + SearchRoom::beyond);
  grow(found.pixels, pixels + SearchRoom::beyond);
  const auto reach = static_cast<std::size_t>(apron_of(filter));
  const std::size_t count =
      steps().search[reach - 1](tile, {found.changes.data(), found.pixels.data()});
  return std::span(found.pixels).first(count);
}

void find_fine_pixels(const Tile& tile, std::vector<Pixel>& found) {
  found.clear();
  if (tile.fine == nullptr) return;
  const std::ptrdiff_t width = tile.area.width();
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
    for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
      const std::size_t at = tile.at(x, y);
      if (!(tile.fine[at] > most_move_squared)) continue;
      float bend = 0;
      for (std::size_t o = 0; o < tile.outputs; ++o)
        for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, width}) {
          const float* middle = tile.planes[o] + at;
          bend = std::max(bend, std::abs(middle[step] + middle[-step] - 2 * middle[0]));
        }
      if (bend > least_fine_bend) found.push_back({.x = x, .y = y});
    }
}

}  // namespace pse::antialias
