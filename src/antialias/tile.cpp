// Comparing neighbours: first paths alone, for whole rows at once, then values where paths differ,
// for four pixels at once.
#include "antialias/tile.h"

#include <bit>
#include <limits>

#include "antialias/four.h"

namespace pse::antialias {
namespace {

// Steps of an output below this, of 1 and of its size, are no edges.
constexpr float least_step = 0.01f;

// From samples with the values `here` to the samples `there`, where those on their other sides have
// `opposite`: whether an output jumps. As differ(), without branches.
Answers jumps(Four here, Four there, Four opposite) {
  constexpr float huge = std::numeric_limits<float>::max();
  const Four apart = size(here - there), largest = larger(size(here), size(there));
  const Answers is_same = (apart <= differ_least + differ_relative * largest) & (apart <= huge);
  const Answers both_nan = (here != here) & (there != there);
  // The neighbour on the other side tells the slope. A step as small as `least` cannot be told from
  // the texture's own detail.
  const Four slope = here - opposite, least = least_step * (1 + largest);
  const Four beyond = size(there - (here + slope)), allowed = larger(size(slope), least);
  return ~(is_same | both_nan | (here == there) | (beyond <= allowed));
}

// What is seen of four pixels.
struct Seen {
  Answers edge{}, silhouette{}, narrow{};
};

// Looks at all pixels whose columns and rows are within `reach`.
template <int reach>
class Search {
 public:
  explicit Search(const Tile& tile)
      : tile_(tile), width_(tile.area.width()), along_rows_(changes_along_rows()) {}

  std::vector<Pixel> run() const {
    std::vector<Pixel> found;
    const auto width = static_cast<std::size_t>(tile_.rect.width());
    std::vector<std::uint32_t> changes(width + four);
    for (int y = tile_.rect.y0; y < tile_.rect.y1; ++y) {
      const std::size_t first = tile_.at(tile_.rect.x0, y);
      if (!paths_change(first, std::span(changes).first(width))) continue;
      for (std::size_t i = 0; i < width; i += four) {
        if ((changes[i] | changes[i + 1] | changes[i + 2] | changes[i + 3]) == 0) continue;
        const std::size_t count = std::min(four, width - i);
        const Seen seen = look(first + i, count);
        const Answers wanted = seen.edge | seen.narrow;
        if (!any(wanted)) continue;
        for (std::size_t k = 0; k < count; ++k)
          if (wanted[k] != 0)
            found.push_back({tile_.rect.x0 + static_cast<int>(i + k), y, seen.silhouette[k] != 0,
                             seen.edge[k] == 0});
      }
    }
    return found;
  }

 private:
  std::uint32_t path(std::size_t at) const {
    return std::bit_cast<std::uint32_t>(tile_.path()[at]);
  }

  // For all samples of the area: not 0 where the path changes along the row within reach.
  std::vector<std::uint32_t> changes_along_rows() const {
    const auto all = static_cast<std::size_t>(width_) *
                     static_cast<std::size_t>(tile_.area.height());
    std::vector<std::uint32_t> changes(all);
    for (std::size_t i = reach; i + reach < all; ++i) {
      std::uint32_t change = 0;
      for (std::size_t k = i - reach; k < i + reach; ++k) change |= path(k) ^ path(k + 1);
      changes[i] = change;
    }
    return changes;
  }

  // For the samples of a row: not 0 where the path changes within reach. Whether there is any.
  bool paths_change(std::size_t first, std::span<std::uint32_t> changes) const {
    const auto width = static_cast<std::size_t>(width_);
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      std::size_t at = first + i - reach * width;
      std::uint32_t change = along_rows_[at];
      for (int k = -reach; k < reach; ++k, at += width)
        change |= (path(at) ^ path(at + width)) | along_rows_[at + width];
      changes[i] = change;
      any |= change;
    }
    return any != 0;
  }

  // `count` pixels in a row.
  Seen look(std::size_t here, std::size_t count) const {
    Seen seen;
    look_along(seen, here, count, 1, true);
    for (std::ptrdiff_t dx = 2; dx <= reach; ++dx) look_along(seen, here, count, dx, false);
    for (std::ptrdiff_t dy = 1; dy <= reach; ++dy)
      for (std::ptrdiff_t dx = -reach; dx <= reach; ++dx)
        look_along(seen, here, count, dy * width_ + dx, dy == 1 && dx == 0);
    seen.narrow &= ~seen.edge;
    return seen;
  }

  // At the two neighbours `step` before and behind each.
  void look_along(Seen& seen, std::size_t here, std::size_t count, std::ptrdiff_t step,
                  bool is_next) const {
    const float* path = tile_.path() + here;
    const Four way = load(path, count);
    const Answers ahead = load(path + step, count) != way, back = load(path - step, count) != way;
    if (!any(ahead | back)) return;
    if (is_next) seen.narrow |= ahead & back;
    Answers jumps_ahead{}, jumps_back{};
    for (std::size_t o = 0; o < tile_.outputs; ++o) {
      const float* at = tile_.planes[o] + here;
      const Four value = load(at, count), a = load(at + step, count), b = load(at - step, count);
      // Most ways through a program end in the same place.
      const Answers far = (ahead & ~(size(a - value) <= differ_least)) |
                          (back & ~(size(b - value) <= differ_least));
      if (!any(far)) continue;
      jumps_ahead |= ahead & jumps(value, a, b);
      jumps_back |= back & jumps(value, b, a);
    }
    seen.edge |= jumps_ahead | jumps_back;
    if (tile_.ids == nullptr) return;
    const float* id = tile_.ids + here;
    const Four object = load(id, count);
    seen.silhouette |= (jumps_ahead & (load(id + step, count) != object)) |
                       (jumps_back & (load(id - step, count) != object));
  }

  const Tile& tile_;
  const std::ptrdiff_t width_;
  const std::vector<std::uint32_t> along_rows_;
};

}  // namespace

int apron_of(const Filter& filter) { return filter.reach() > 1.01f ? 2 : 1; }

std::vector<Pixel> find_edge_pixels(const Tile& tile, const Filter& filter) {
  return apron_of(filter) == 1 ? Search<1>(tile).run() : Search<2>(tile).run();
}

}  // namespace pse::antialias
