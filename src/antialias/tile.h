// A tile's samples with an apron around them, and which of its pixels an edge may cross.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "antialias/filter.h"
#include "stream/executor.h"

namespace pse::antialias {

// Samples of `area`, which is `rect` and some pixels around it, in row-major order of `area`.
struct Tile {
  Rect rect, area;
  std::span<float* const> planes;  // the outputs; behind them the path, and the ends if any
  std::size_t outputs = 0;         // without these
  const float* fine = nullptr;     // of path.h; null: nothing is fine
  const float* bent = nullptr;     // likewise; null: every edge is seen
  const float* ids = nullptr;      // of the objects that the samples show; null: there is but one

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - area.y0) * static_cast<std::size_t>(area.width()) +
           static_cast<std::size_t>(x - area.x0);
  }
  // Of path.h. Null where all go the same way; ends are null where no loop searches.
  const float* path() const { return planes.size() > outputs ? planes[outputs] : nullptr; }
  const float* ends() const { return planes.size() > outputs + 1 ? planes[outputs + 1] : nullptr; }
};

// How strong noise is where it is fine.
enum class Grain : std::uint8_t {
  none,
  coarse,  // an edge's two sides do not tell of the pixel
  fine,    // nor do samples half a pixel apart
};

struct Pixel {
  int x = 0, y = 0;
  bool silhouette = false;  // a neighbour shows another object
  // Nothing jumps, but more than one decision falls differently a pixel further: there may be
  // something in between that no sample has met.
  bool narrow = false;
  // Narrow at most: a crease lies in between. Only where another edge is near there may be
  // something.
  bool hidden = false;
  // No pixel around goes another way, but the path says that an edge is near which bends.
  bool unseen = false;
  // Pixels on opposite sides go other ways, where there are edges that bend.
  bool enclosed = false;
  // The program does not tell where the edges are: a search ends elsewhere, or hardly a neighbour
  // goes the same way.
  bool untold = false;
  // Bit k: some output jumps towards neighbour k of `around`.
  std::uint8_t jumps = 0;
  Grain grain = Grain::none;

  // The pixels around one: every other one is opposite to the one before.
  static constexpr int around[8][2] = {{1, 0}, {-1, 0}, {-1, 1}, {1, -1},
                                       {0, 1}, {0, -1}, {1, 1},  {-1, -1}};
};

// Whether two values of an output look different; they do not where they are nearer than this.
inline constexpr float differ_least = 0.002f, differ_relative = 0.004f;
inline bool differ(float a, float b) {
  const float apart = std::abs(a - b);
  if (apart <= differ_least) return false;
  if (a == b || (std::isnan(a) && std::isnan(b))) return false;
  return !(apart <= differ_least + differ_relative * std::max(std::abs(a), std::abs(b))) ||
         std::isinf(apart);
}

// How many pixels around a tile find_edge_pixels() looks at.
int apron_of(const Filter& filter);

// The pixels of tile.rect where noise is finer than a pixel (fine.h) and some output deviates
// visibly from its mean by what its neighbours tell nothing of. In row-major order.
// `found` is memory, used again.
std::span<const Pixel> find_fine_pixels(const Tile& tile, std::vector<Pixel>& found);

// Memory of find_edge_pixels(), used again from tile to tile.
struct Found {
  std::vector<std::uint16_t> changes;
  std::vector<Pixel> pixels;
};

// The pixels of tile.rect that have a neighbour whose path is another, or whose searches end
// elsewhere, across which some output jumps: more than its slope on the near side explains; and
// those that are narrow. In row-major order. Neighbours are the samples that an edge under the
// kernel separates from the pixel; tile.area must reach apron_of() pixels around tile.rect. Depends
// on nothing but those samples.
std::span<const Pixel> find_edge_pixels(const Tile& tile, const Filter& filter, Found& found);

}  // namespace pse::antialias
