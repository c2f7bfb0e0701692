// Comparing neighbours: first paths alone, for whole rows at once, then values where paths differ.
#include "antialias/tile.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace pse::antialias {
namespace {

// Steps of an output below this, of 1 and of its size, are no edges.
constexpr float least_step = 0.01f;

// Four values side by side, and four answers: 0 or -1.
using Four = float __attribute__((vector_size(16)));
using Answers = std::int32_t __attribute__((vector_size(16)));

Four size(Four values) {
  const Answers bits = std::bit_cast<Answers>(values) & 0x7fffffff;
  return std::bit_cast<Four>(bits);
}
Four larger(Four a, Four b) { return a > b ? a : b; }
bool any(Answers answers) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(answers);
  return (halves[0] | halves[1]) != 0;
}

// From a sample with `value` to the samples `there`, where those on its other side have `opposite`:
// whether an output jumps. As differ(), without branches.
Answers jumps(float value, Four there, Four opposite) {
  constexpr float huge = std::numeric_limits<float>::max();
  const Four here = Four{} + value;
  const Four apart = size(here - there), largest = larger(size(here), size(there));
  const Answers is_same = (apart <= differ_least + differ_relative * largest) & (apart <= huge);
  const Answers both_nan = (here != here) & (there != there);
  // The neighbour on the other side tells the slope. A step as small as `least` cannot be told from
  // the texture's own detail.
  const Four slope = here - opposite, least = least_step * (1 + largest);
  const Four beyond = size(there - (here + slope)), allowed = larger(size(slope), least);
  return ~(is_same | both_nan | (here == there) | (beyond <= allowed));
}

// Four neighbours of a sample: two and those on their other sides.
struct Neighbours {
  std::ptrdiff_t a, b;

  Four operator()(const float* at) const { return Four{at[a], at[-a], at[b], at[-b]}; }
  static Four opposite(Four values) { return __builtin_shufflevector(values, values, 1, 0, 3, 2); }
};

// The first `count` of: along the axes, along the diagonals (corners reach into pixels from there),
// two pixels away.
template <std::size_t count>
std::array<Neighbours, count> neighbours(std::ptrdiff_t width) {
  const std::array<Neighbours, 6> all = {{{1, width},
                                          {width - 1, width + 1},
                                          {2, 2 * width},
                                          {2 * width - 2, 2 * width + 2},
                                          {2 * width - 1, 2 * width + 1},
                                          {width - 2, width + 2}}};
  std::array<Neighbours, count> some;
  std::copy_n(all.begin(), count, some.begin());
  return some;
}

template <std::size_t count>
class Search {
 public:
  explicit Search(const Tile& tile) : tile_(tile), around_(neighbours<count>(tile.area.width())) {}

  std::vector<Pixel> run() const {
    std::vector<Pixel> found;
    std::vector<std::uint32_t> changes(static_cast<std::size_t>(tile_.rect.width()));
    for (int y = tile_.rect.y0; y < tile_.rect.y1; ++y) {
      const std::size_t first = tile_.at(tile_.rect.x0, y);
      if (!paths_change(first, changes)) continue;
      for (std::size_t i = 0; i < changes.size(); ++i) {
        bool silhouette = false;
        if (changes[i] != 0 && is_edge(first + i, silhouette))
          found.push_back({tile_.rect.x0 + static_cast<int>(i), y, silhouette});
      }
    }
    return found;
  }

 private:
  // For the samples of a row: not 0 where a neighbour's path is another. Whether there is any.
  bool paths_change(std::size_t first, std::span<std::uint32_t> changes) const {
    const float* path = tile_.path() + first;
    const auto bits = [path](std::ptrdiff_t at) { return std::bit_cast<std::uint32_t>(path[at]); };
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const auto x = static_cast<std::ptrdiff_t>(i);
      const std::uint32_t here = bits(x);
      std::uint32_t change = 0;
      for (const auto& [a, b] : around_)
        change |= (bits(x + a) ^ here) | (bits(x - a) ^ here) | (bits(x + b) ^ here) |
                  (bits(x - b) ^ here);
      changes[i] = change;
      any |= change;
    }
    return any != 0;
  }

  // Whether an output jumps towards a neighbour with another path; and for one of these
  // (`silhouette`) also the object is another.
  bool is_edge(std::size_t here, bool& silhouette) const {
    const float* path = tile_.path() + here;
    bool edge = false;
    for (std::size_t o = 0; o < tile_.outputs; ++o) {
      const float* at = tile_.planes[o] + here;
      Answers found{}, objects{};
      for (const Neighbours& four : around_) {
        const Four there = four(at);
        // Most ways through a program end in the same place.
        if (!any(~(size(there - *at) <= differ_least))) continue;
        const Answers jump = jumps(*at, there, Neighbours::opposite(there)) & (four(path) != *path);
        found |= jump;
        if (tile_.ids) objects |= jump & (four(tile_.ids + here) != tile_.ids[here]);
      }
      edge = edge || any(found);
      silhouette = silhouette || any(objects);
      if (edge && (!tile_.ids || silhouette)) break;
    }
    return edge;
  }

  const Tile& tile_;
  const std::array<Neighbours, count> around_;
};

}  // namespace

int apron_of(const Filter& filter) { return filter.reach() > 1.01f ? 2 : 1; }

std::vector<Pixel> find_edge_pixels(const Tile& tile, const Filter& filter) {
  return apron_of(filter) == 1 ? Search<2>(tile).run() : Search<6>(tile).run();
}

}  // namespace pse::antialias
