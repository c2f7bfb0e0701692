// A tile's samples with an apron around them, and which of its pixels an edge may cross.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "stream/executor.h"

namespace pse::antialias {

// Samples of `area`, which is `rect` and some pixels around it, in row-major order of `area`.
struct Tile {
  Rect rect, area;
  std::span<float* const> planes;  // the outputs; the path where there is one is the last
  std::size_t outputs = 0;         // without the path
  const float* ids = nullptr;      // of the objects that the samples show; null: there is but one

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - area.y0) * static_cast<std::size_t>(area.width()) +
           static_cast<std::size_t>(x - area.x0);
  }
  const float* path() const { return planes[outputs]; }
};

struct Pixel {
  int x = 0, y = 0;
  bool silhouette = false;  // a neighbour shows another object
};

// Whether two values of an output look different.
inline bool differ(float a, float b) {
  constexpr float absolute = 0.002f, relative = 0.004f;
  const float apart = std::abs(a - b);
  if (apart <= absolute) return false;
  if (a == b || (std::isnan(a) && std::isnan(b))) return false;
  return !(apart <= absolute + relative * std::max(std::abs(a), std::abs(b))) || std::isinf(apart);
}

// The pixels of tile.rect that have a neighbour within `reach` pixels (1 or 2) whose path is
// another, across which some output jumps: more than its slope on the near side explains. In
// row-major order. tile.area must reach that far around tile.rect. Depends on nothing but the
// samples within `reach` of each pixel.
std::vector<Pixel> find_edge_pixels(const Tile& tile, int reach);

}  // namespace pse::antialias
