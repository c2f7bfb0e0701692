// The pixels that samples half a pixel apart are enough for: half_grid.h, put to work on a tile.
#include <algorithm>
#include <cmath>

#include "antialias/refine.h"
#include "antialias/steps.h"

namespace pse::antialias {
namespace {

// Places handed to the program at once.
constexpr std::size_t most_together = 1024;

}  // namespace

// Runs all samples of the grid.
void Refiner::fill_halves(Work& work, RunStatus& status) const {
  HalfGrid& grid = work.halves;
  const auto runs = grid.runs();
  for (std::size_t next = 0; next < runs.size() && !status.stopped();) {
    const std::size_t first = next;
    std::size_t count = 0;
    const auto size = [&](std::size_t k) { return static_cast<std::size_t>(runs[k].count); };
    while (next < runs.size() && (count == 0 || count + size(next) <= most_together))
      count += size(next++);
    work.places.resize(count);
    count = 0;
    for (std::size_t k = first; k < next; count += size(k++))
      grid.places(runs[k], work.places.x.data() + count, work.places.y.data() + count);
    const Results& results = program_.run(work, status);
    for (std::size_t o = 0; o < outputs_; ++o) {
      if (courses_[o] != Course::bent) continue;
      const float* from = results[o];
      for (std::size_t k = first; k < next; from += size(k++))
        std::copy_n(from, size(k), grid.at(runs[k].kind, o, runs[k].x, runs[k].y));
    }
  }
}

// Means are written at the end of the result; where one is no finite number the pixel stays as it
// is, and so do outputs that are even or made of stored pixels.
void Refiner::settle_halves(const Tile& tile, Refined& result, Counts& counts, Work& work,
                            RunStatus& status) const {
  const std::vector<Pixel>& pixels = work.halved;
  if (pixels.empty()) return;
  HalfGrid& grid = work.halves;
  grid.begin(tile.rect, pixels, outputs_);
  fill_halves(work, status);

  const auto width = static_cast<std::size_t>(tile.rect.width());
  const std::size_t room = width + HalfGrid::beyond;
  work.sums.resize(outputs_ * room);
  std::size_t kept = result.pixels.size();
  const std::size_t before = kept;
  result.resize(before + pixels.size());
  for (std::size_t i = 0; i < pixels.size();) {
    // All pixels of a row from its first on.
    const int y = pixels[i].y, first = pixels[i].x;
    std::size_t end = i;
    while (end < pixels.size() && pixels[end].y == y) ++end;
    const auto count = static_cast<std::size_t>(pixels[end - 1].x - first + 1);
    const std::size_t here = tile.at(first, y);
    for (std::size_t o = 0; o < outputs_; ++o) {
      float* const means = work.sums.data() + o * room;
      if (courses_[o] != Course::bent) {
        std::copy_n(tile.planes[o] + here, count, means);
        continue;
      }
      const int x = first - tile.rect.x0, row = y - tile.rect.y0;
      const HalfRow at{tile.path() + here,
                       tile.planes[o] + here,
                       grid.at(Half::beside, o, x, row),
                       grid.at(Half::below, o, x, row),
                       grid.at(Half::corner, o, x, row),
                       tile.area.width(),
                       static_cast<std::ptrdiff_t>(grid.row())};
      steps().mean_of_halves(at, *half_means_, count, means);
    }
    for (; i < end; ++i) {
      const auto at = static_cast<std::size_t>(pixels[i].x - first);
      bool is_finite = true;
      result.pixels[kept] = pixels[i];
      for (std::size_t o = 0; o < outputs_; ++o) {
        const float mean = work.sums[o * room + at];
        is_finite = is_finite && (courses_[o] != Course::bent || std::isfinite(mean));
        result.values[o][kept] = mean;
      }
      kept += is_finite;
    }
  }
  result.resize(kept);
  counts.supersampled += static_cast<std::int64_t>(kept - before);
}

}  // namespace pse::antialias
