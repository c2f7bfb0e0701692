// Comparing neighbours: first paths alone, for all pixels at once, then values where paths differ.
#include "antialias/tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace pse::antialias {
namespace {

// Steps of an output below this, of 1 and of its size, are no edges.
constexpr float least_step = 0.01f;

// Between the sample `here` and its neighbour `step` samples on: whether some output jumps. The
// neighbour on the other side tells the slope.
bool jumps(const Tile& tile, std::size_t here, std::ptrdiff_t step) {
  for (std::size_t o = 0; o < tile.outputs; ++o) {
    const float* at = tile.planes[o] + here;
    const float value = at[0], there = at[step];
    if (!differ(value, there)) continue;
    const float slope = value - at[-step], expected = value + slope;
    // A step as small as that cannot be told from the texture's own detail.
    const float least = least_step * (1 + std::max(std::abs(value), std::abs(there)));
    const float beyond = std::abs(there - expected);
    if (!(beyond <= std::max(std::abs(slope), least))) return true;
  }
  return false;
}

// Steps to all samples within reach, the nearest first.
std::vector<std::ptrdiff_t> neighbours(const Tile& tile, int reach) {
  std::vector<std::pair<int, std::ptrdiff_t>> found;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (dx != 0 || dy != 0)
        found.push_back({dx * dx + dy * dy, dy * std::ptrdiff_t{tile.area.width()} + dx});
  std::ranges::sort(found);
  std::vector<std::ptrdiff_t> steps;
  for (const auto& [far, step] : found) steps.push_back(step);
  return steps;
}

// Where paths change in the area of a tile: for each pixel of each row the bits by which the paths
// of pixels within `reach` columns differ, and those by which the path below does.
class Changes {
 public:
  Changes(const Tile& tile, int reach)
      : tile_(tile), reach_(reach), width_(static_cast<std::size_t>(tile.rect.width())) {
    const Rect& area = tile.area;
    const auto rows = static_cast<std::size_t>(area.height());
    along_.resize(rows * width_), below_.resize(rows * width_);
    rows_.resize(rows);
    std::vector<std::uint32_t> steps(width_ + 2 * static_cast<std::size_t>(reach));
    for (int y = area.y0; y < area.y1; ++y) {
      const float* path = tile.path() + tile.at(tile.rect.x0 - reach, y);
      difference(path, path + 1, steps.size() - 1, steps.data());
      std::uint32_t* along = along_.data() + at(y);
      for (int k = 0; k < 2 * reach; ++k)
        for (std::size_t x = 0; x < width_; ++x) along[x] |= steps[x + static_cast<std::size_t>(k)];
      const float* here = tile.path() + tile.at(tile.rect.x0, y);
      if (y + 1 < area.y1) difference(here, here + area.width(), width_, below_.data() + at(y));
      std::uint32_t any = 0;
      for (std::size_t x = 0; x < width_; ++x) any |= along[x] | below_[at(y) + x];
      rows_[static_cast<std::size_t>(y - area.y0)] = any != 0;
    }
  }

  // Into `changes`, for each pixel of row y: not 0 where some path within reach is another. False
  // where the whole row has none.
  bool around(int y, std::span<std::uint32_t> changes) const {
    const int first = y - reach_, last = y + reach_;
    const auto of_row = [&](int row) { return rows_.begin() + (row - tile_.area.y0); };
    if (std::none_of(of_row(first), of_row(last) + 1, std::identity())) return false;
    std::ranges::fill(changes, 0u);
    for (int row = first; row <= last; ++row) {
      for (std::size_t x = 0; x < width_; ++x) changes[x] |= along_[at(row) + x];
      if (row == last) break;
      for (std::size_t x = 0; x < width_; ++x) changes[x] |= below_[at(row) + x];
    }
    return true;
  }

 private:
  std::size_t at(int y) const { return static_cast<std::size_t>(y - tile_.area.y0) * width_; }

  static void difference(const float* a, const float* b, std::size_t count, std::uint32_t* out) {
    for (std::size_t i = 0; i < count; ++i)
      out[i] = std::bit_cast<std::uint32_t>(a[i]) ^ std::bit_cast<std::uint32_t>(b[i]);
  }

  const Tile& tile_;
  const int reach_;
  const std::size_t width_;
  std::vector<std::uint32_t> along_, below_;
  std::vector<std::uint8_t> rows_;  // whether anything changes in or below a row
};

}  // namespace

std::vector<Pixel> find_edge_pixels(const Tile& tile, int reach) {
  std::vector<Pixel> found;
  const Changes all(tile, reach);
  const std::vector<std::ptrdiff_t> steps = neighbours(tile, reach);
  std::vector<std::uint32_t> changes(static_cast<std::size_t>(tile.rect.width()));
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y) {
    if (!all.around(y, changes)) continue;
    const std::size_t first = tile.at(tile.rect.x0, y);
    for (std::size_t i = 0; i < changes.size(); ++i) {
      if (changes[i] == 0) continue;
      const std::size_t here = first + i;
      const float* path = tile.path() + here;
      bool edge = false, silhouette = false;
      for (const std::ptrdiff_t step : steps) {
        if (path[0] == path[step] || !jumps(tile, here, step)) continue;
        edge = true;
        if (!tile.ids) break;
        silhouette = tile.ids[here] != (tile.ids + here)[step];
        if (silhouette) break;
      }
      if (edge) found.push_back({tile.rect.x0 + static_cast<int>(i), y, silhouette});
    }
  }
  return found;
}

}  // namespace pse::antialias
