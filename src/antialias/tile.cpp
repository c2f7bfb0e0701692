// Comparing neighbours: first paths alone, for all pixels at once, then values where paths differ.
#include "antialias/tile.h"

#include <algorithm>
#include <cmath>

namespace pse::antialias {
namespace {

// Steps of an output below this, of 1 and of its size, are no edges.
constexpr float least_step = 0.01f;

bool is_known(const Rect& area, int x, int y) {
  return x >= area.x0 && x < area.x1 && y >= area.y0 && y < area.y1;
}

// Between the pixel and its neighbour (dx, dy): whether some output jumps.
bool jumps(const Tile& tile, int x, int y, int dx, int dy) {
  const std::size_t here = tile.at(x, y), there = tile.at(x + dx, y + dy);
  // The neighbour on the other side tells the slope.
  const bool has_slope = is_known(tile.area, x - dx, y - dy);
  for (std::size_t o = 0; o < tile.outputs; ++o) {
    const float* value = tile.planes[o];
    if (!differ(value[here], value[there])) continue;
    if (!has_slope) return true;
    const float slope = value[here] - value[tile.at(x - dx, y - dy)];
    const float expected = value[here] + slope;
    // A step as small as that cannot be told from the texture's own detail.
    const float least = least_step * (1 + std::max(std::abs(value[here]), std::abs(value[there])));
    const float step = std::abs(value[there] - expected);
    if (!(step <= std::max(std::abs(slope), least))) return true;
  }
  return false;
}

// For the pixels of one row: whether the path at (dx, dy) is another.
void compare_row(const Tile& tile, int y, int dx, int dy, std::vector<std::uint8_t>& differs) {
  if (y + dy < tile.area.y0 || y + dy >= tile.area.y1) return;
  const int first = std::max(tile.rect.x0, tile.area.x0 - dx);
  const int last = std::min(tile.rect.x1, tile.area.x1 - dx);
  if (first >= last) return;
  const float* here = tile.path() + tile.at(first, y);
  const float* there = tile.path() + tile.at(first + dx, y + dy);
  std::uint8_t* out = differs.data() + (first - tile.rect.x0);
  for (int i = 0; i < last - first; ++i) out[i] |= here[i] != there[i];
}

}  // namespace

bool differ(float a, float b) {
  constexpr float absolute = 0.002f, relative = 0.004f;
  if (a == b || (std::isnan(a) && std::isnan(b))) return false;
  const float apart = std::abs(a - b), size = std::max(std::abs(a), std::abs(b));
  return !(apart <= absolute + relative * size) || std::isinf(apart);
}

std::vector<Pixel> find_edge_pixels(const Tile& tile, int reach) {
  std::vector<Pixel> found;
  std::vector<std::uint8_t> differs(static_cast<std::size_t>(tile.rect.width()));
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y) {
    std::ranges::fill(differs, std::uint8_t{0});
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx)
        if (dx != 0 || dy != 0) compare_row(tile, y, dx, dy, differs);
    for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
      if (!differs[static_cast<std::size_t>(x - tile.rect.x0)]) continue;
      const auto edge_towards = [&](int dx, int dy) {
        return is_known(tile.area, x + dx, y + dy) &&
               tile.path()[tile.at(x, y)] != tile.path()[tile.at(x + dx, y + dy)] &&
               jumps(tile, x, y, dx, dy);
      };
      bool edge = false, silhouette = false;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          if ((edge && !tile.ids) || silhouette || !edge_towards(dx, dy)) continue;
          edge = true;
          silhouette = tile.ids && tile.ids[tile.at(x, y)] != tile.ids[tile.at(x + dx, y + dy)];
        }
      if (edge) found.push_back({x, y, silhouette});
    }
  }
  return found;
}

}  // namespace pse::antialias
