// Who compares the neighbours, and the memory for it.
#include "antialias/tile.h"

#include "antialias/search.h"

namespace pse::antialias {
namespace {

// The search for this processor.
SearchFunction search_of(int reach) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0)
    return search_for_avx512(reach);
  if (__builtin_cpu_supports("avx2") != 0) return search_for_avx2(reach);
#endif
  return search_for_any(reach);
}

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
  const int reach = apron_of(filter);
  const std::size_t count = search_of(reach)(tile, {found.changes.data(), found.pixels.data()});
  return std::span(found.pixels).first(count);
}

}  // namespace pse::antialias
