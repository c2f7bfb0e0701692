// The memory for comparing neighbours, and the looking for what is finer than they are.
#include "antialias/tile.h"

#include "antialias/steps.h"

namespace pse::antialias {

int apron_of(const Filter& filter) { return filter.reach() > 1.01f ? 2 : 1; }

std::span<const Pixel> find_edge_pixels(const Tile& tile, const Filter& filter, Found& found) {
  const auto samples =
      static_cast<std::size_t>(tile.area.width()) * static_cast<std::size_t>(tile.area.height());
  const auto pixels =
      static_cast<std::size_t>(tile.rect.width()) * static_cast<std::size_t>(tile.rect.height());
  const auto grow = [](auto& list, std::size_t size) {
    if (list.size() < size) list.resize(size);
  };
  grow(found.changes, samples);
  grow(found.pixels, pixels + SearchRoom::beyond);
  const auto reach = static_cast<std::size_t>(apron_of(filter));
  const std::size_t count =
      steps().search[reach - 1](tile, {found.changes.data(), found.pixels.data()});
  return std::span(found.pixels).first(count);
}

std::span<const Pixel> find_fine_pixels(const Tile& tile, std::vector<Pixel>& found) {
  if (tile.fine == nullptr) return {};
  const auto pixels =
      static_cast<std::size_t>(tile.rect.width()) * static_cast<std::size_t>(tile.rect.height());
  if (found.size() < pixels) found.resize(pixels);
  return std::span(found).first(steps().find_fine(tile, found.data()));
}

}  // namespace pse::antialias
