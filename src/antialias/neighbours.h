// The comparing of neighbours (tile.h) itself, for the instructions that the including file is
// compiled for (steps.h). Paths first, for whole rows at once, then values where paths differ, for
// eight or sixteen pixels at once. Nothing here may be kept out of line but what is local, since
// the linker would take one such function for all; hence no standard containers.
#pragma once

#include "antialias/lanes.h"
#include "antialias/path.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

// Steps of an output below this, of 1 and of its size, are no edges: they cannot be told from the
// texture's own detail.
constexpr float least_step = 0.01f;

// A picture that bends by more between three samples in a row is changed by its mean over a pixel.
constexpr float least_bend = 0.08f;

// Searches end in the same place where their ends differ by less.
constexpr float least_end = 0.05f;

// Nearer than this to a value, others do not jump from it.
template <class V>
[[gnu::always_inline]] inline V least_step_from(V value) {
  constexpr float huge = 1e30f;
  return least_step * (1 + smaller(size(value), V{} + huge));
}

// Whether an output jumps from samples to opposite neighbours, which differ by so much from them.
template <class V>
struct Jumps {
  AnswersOf<V> ahead, back;
};
// Where both neighbours go other ways (`alone`), neither tells a slope.
template <class V>
[[gnu::always_inline]] inline Jumps<V> jumps(V to_ahead, V to_back, V least, AnswersOf<V> alone) {
  // The neighbour on the other side tells the slope, and so where this one would be without a jump.
  const V beyond = size(to_ahead + to_back), up = size(to_ahead), down = size(to_back);
  return {~((up <= least) | (~alone & (beyond <= larger(down, least)))),
          ~((down <= least) | (~alone & (beyond <= larger(up, least))))};
}

// Looks at all pixels whose columns and rows are within `reach`, `count` at once.
template <std::size_t count, int reach>
class Search {
  using Values = typename LanesOf<count>::Floats;
  using Answers = AnswersOf<Values>;
  // To the sample `by` further, and the bit of Pixel::jumps for it; 0 where there is none.
  struct Step {
    std::ptrdiff_t by;
    std::int32_t bit = 0;
  };
  // What is seen of so many pixels.
  struct Seen {
    Answers edge{}, silhouette{}, narrow{}, hidden{}, unseen{}, enclosed{}, untold{};
    Answers jumps{};  // Pixel::jumps
  };

 public:
  [[gnu::always_inline]] Search(const Tile& tile, const SearchRoom& room)
      : tile_(tile),
        room_(room),
        width_(tile.area.width()),
        groups_((tile.rect.width() + at_once - 1) / at_once),
        apart_(groups_ * tile.area.height()),
        path_(tile.path()),
        ends_(tile.ends()),
        bent_(tile.bent) {
    Step* step = steps_;
    for (std::ptrdiff_t dx = 1; dx <= reach; ++dx) *step++ = {dx};
    for (std::ptrdiff_t dy = 1; dy <= reach; ++dy)
      for (std::ptrdiff_t dx = -reach; dx <= reach; ++dx) *step++ = {dy * width_ + dx};
    for (Step& to : steps_)
      for (int k = 0; k < 8; k += 2)
        if (to.by == Pixel::around[k][0] + Pixel::around[k][1] * width_) to.bit = 1 << k;
  }

  [[gnu::always_inline]] std::size_t run() const {
    see_changes();
    Pixel* next = room_.found;
    const std::ptrdiff_t width = tile_.rect.width();
    std::ptrdiff_t group = reach * groups_;
    for (int y = tile_.rect.y0; y < tile_.rect.y1; ++y) {
      const auto first = static_cast<std::ptrdiff_t>(tile_.at(tile_.rect.x0, y));
      for (std::ptrdiff_t i = 0; i < width; i += at_once, ++group) {
        if (changes_around(group) == 0) continue;
        next = list(look(first + i), static_cast<int>(i), y, next);
      }
    }
    return static_cast<std::size_t>(next - room_.found);
  }

 private:
  static constexpr std::ptrdiff_t at_once = count;
  static constexpr int directions = 2 * reach * (reach + 1);

  // Writes those of a group, columns `left` of the tile and on, that are wanted. Gives where the
  // next are to be written.
  [[gnu::always_inline]] Pixel* list(const Seen& seen, int left, int y, Pixel* next) const {
    std::uint32_t wanted = mask_of(seen.edge | seen.narrow | seen.hidden | seen.unseen);
    const int width = tile_.rect.width() - left;
    if (width < static_cast<int>(at_once)) wanted &= (1u << width) - 1;
    if (wanted == 0) return next;
    // The bytes behind a pixel's place, in two halves.
    const Answers flags[] = {
        (seen.silhouette & 1) | (~seen.edge & 1 << 8) | (seen.hidden & 1 << 16) |
            (seen.unseen & 1 << 24),
        (seen.enclosed & 1) | (seen.untold & seen.edge & 1 << 8) | (seen.jumps << 16)};
    std::int32_t first[count], second[count];
    store(first, flags[0]), store(second, flags[1]);
    for (; wanted != 0; wanted &= wanted - 1) {
      const auto k = __builtin_ctz(wanted);
      const std::int32_t bytes[] = {tile_.rect.x0 + left + k, y, first[k], second[k]};
      static_assert(sizeof bytes == sizeof *next);
      std::memcpy(next++, bytes, sizeof bytes);
    }
    return next;
  }

  // Whether the searches of samples end in different places.
  [[gnu::always_inline]] Answers end_apart(std::ptrdiff_t here, std::ptrdiff_t there) const {
    return ~(size(load<Values>(ends_ + there) - load<Values>(ends_ + here)) <= least_end);
  }
  [[gnu::always_inline]] Answers changes(std::ptrdiff_t here, std::ptrdiff_t there) const {
    const Answers change = load<Answers>(path_ + here) ^ load<Answers>(path_ + there);
    return ends_ == nullptr ? change : change | end_apart(here, there);
  }

  // For each group of `count` samples in the tile's columns, of all rows of the area: a bit for
  // each where the path changes along the row within reach; likewise from here to each row below.
  [[gnu::always_inline]] void see_changes() const {
    const int rows = tile_.area.height();
    std::uint16_t* to = room_.changes;
    for (int row = 0; row < rows; ++row) {
      const std::ptrdiff_t first = row * width_ + reach;
      for (std::ptrdiff_t group = 0; group < groups_; ++group, ++to) {
        const std::ptrdiff_t here = first + group * at_once;
        Answers change{};
        for (int k = 1; k <= reach; ++k)
          change |= changes(here, here - k) | changes(here, here + k);
        if (bent_ != nullptr) change |= load<Answers>(bent_ + here);
        *to = static_cast<std::uint16_t>(mask_of(change != 0));
        for (int k = 1; k <= reach; ++k)
          to[k * apart_] =
              row + k < rows
                  ? static_cast<std::uint16_t>(mask_of(changes(here, here + k * width_) != 0))
                  : std::uint16_t{0};
      }
    }
  }

  // Where the path changes within reach.
  [[gnu::always_inline]] std::uint32_t changes_around(std::ptrdiff_t group) const {
    const std::uint16_t* at = room_.changes + group;
    std::uint32_t change = *at;
    for (int k = 1; k <= reach; ++k) {
      const std::ptrdiff_t above = -k * groups_, below = k * groups_;
      change |= at[above] | at[below] | at[k * apart_] | at[k * apart_ + above];
    }
    return change;
  }

  // Where the neighbours `to` before and behind go other ways: by the path alone.
  struct Ways {
    Answers ahead[directions], back[directions];
  };
  [[gnu::always_inline]] Ways ways(std::ptrdiff_t here) const {
    const Answers way = load<Answers>(path_ + here);
    Ways found;
    for (int d = 0; d < directions; ++d) {
      found.ahead[d] = load<Answers>(path_ + here + steps_[d].by) != way;
      found.back[d] = load<Answers>(path_ + here - steps_[d].by) != way;
    }
    return found;
  }

  // At pixels in a row; what is said of those behind the row's end has no meaning.
  [[gnu::always_inline]] Seen look(std::ptrdiff_t here) const {
    Seen seen;
    const Ways to = ways(here);
    Answers other{};
    for (int d = 0; d < directions; ++d) other |= to.ahead[d] | to.back[d];
    // Where a search ends is no way of its own.
    if (ends_ != nullptr || any(other)) {
      for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, width_}) {
        see_leap(seen, here, here + step);
        see_leap(seen, here, here - step);
      }
      for (std::size_t o = 0; o < tile_.outputs; ++o)
        see_jumps(seen, here, to, other, tile_.planes[o]);
      seen.narrow &= ~seen.edge;
      seen.hidden &= ~(seen.edge | seen.narrow);
      if (any(seen.edge)) seen.untold |= is_crowded(here, to, seen.edge);
    }
    if (bent_ != nullptr) see_bent(seen, here, to, other);
    return seen;
  }

  // Where edges bend within the kernel's reach.
  [[gnu::always_inline]] void see_bent(Seen& seen, std::ptrdiff_t here, const Ways& to,
                                       Answers other) const {
    for (int d = 0; d < directions; ++d) seen.enclosed |= to.ahead[d] & to.back[d] & seen.edge;
    seen.unseen |= (load<Values>(bent_ + here) != 0) & ~other;
  }

  // Where an output jumps between ways. Most ways through a program end in the same place.
  [[gnu::always_inline]] void see_jumps(Seen& seen, std::ptrdiff_t here, const Ways& to,
                                        Answers other, const float* plane) const {
    const Values value = load<Values>(plane + here), least = least_step_from(value);
    // As bits, since NaN is the largest of these.
    Answers farthest{};
    for (const Step& step : steps_)
      farthest = larger(farthest, larger(bits(size(load<Values>(plane + here + step.by) - value)),
                                         bits(size(load<Values>(plane + here - step.by) - value))));
    Answers far = farthest > bits(least);
    // Of what is known to be an edge there may be more to tell.
    if (ends_ == nullptr) far &= other;
    if (ends_ == nullptr && tile_.ids == nullptr) far &= ~seen.edge;
    if (!any(far)) return;
    for (int d = 0; d < directions; ++d)
      see_jumps_along(seen, here, steps_[d], to.ahead[d], to.back[d], plane, least, far);
  }

  // To the two neighbours `to` before and behind each of those that are `far` from some neighbour.
  [[gnu::always_inline]] void see_jumps_along(Seen& seen, std::ptrdiff_t here, const Step& to,
                                              Answers ahead, Answers back, const float* plane,
                                              Values least, Answers far) const {
    const std::ptrdiff_t step = to.by;
    Jumps<Values> ends{};
    if (ends_ != nullptr) {
      ends = jumps(apart(ends_, here, step), apart(ends_, here, -step), Values{} + least_end,
                   Answers{});
      ahead |= ends.ahead, back |= ends.back;
    }
    ahead &= far, back &= far;
    if (!any(ahead | back)) return;
    const Values to_ahead = apart(plane, here, step), to_back = apart(plane, here, -step);
    const Jumps<Values> found = jumps(to_ahead, to_back, least, ahead & back);
    const Answers jumps_ahead = ahead & found.ahead, jumps_back = back & found.back;
    seen.edge |=
        jumps_ahead | jumps_back | ((ahead | back) & (size(to_ahead + to_back) > least_bend));
    seen.jumps |= (jumps_ahead & to.bit) | (jumps_back & (to.bit << 1));
    seen.untold |= (jumps_ahead & ends.ahead) | (jumps_back & ends.back);
    if (tile_.ids == nullptr) return;
    const float* id = tile_.ids + here;
    const Values object = load<Values>(id);
    seen.silhouette |= (jumps_ahead & (load<Values>(id + step) != object)) |
                       (jumps_back & (load<Values>(id - step) != object));
  }

  // How much a plane changes by a step. Infinities and what is no number differ not from the same.
  [[gnu::always_inline]] static Values apart(const float* plane, std::ptrdiff_t here,
                                             std::ptrdiff_t step) {
    const Values from = load<Values>(plane + here), to = load<Values>(plane + here + step);
    return choose(bits(from) == bits(to), Values{}, to - from);
  }

  // Whether more than one decision falls differently (path.cpp): narrow; or a crease: hidden.
  [[gnu::always_inline]] void see_leap(Seen& seen, std::ptrdiff_t here,
                                       std::ptrdiff_t there) const {
    const Values a = load<Values>(path_ + here), b = load<Values>(path_ + there);
    const Answers apart = (whole(a) - whole(b)) & ((1 << bits_of_jumps) - 1);
    constexpr int most = one_crease / 2;
    const Answers steps = ((apart + most) & (one_crease - 1)) - most;
    const Answers creases = (apart - steps) & ((1 << bits_of_counts) - 1);
    seen.narrow |= (steps < -1) | (steps > 1) | ((apart != 0) & (steps == 0) & (creases == 0));
    seen.hidden |= creases != 0;
  }

  // Whether too few of the eight pixels around go the same way for one or two edges to part them,
  // and these are not parted by one or two either: a pixel may have a way of its own because its
  // middle is on an edge.
  [[gnu::always_inline]] Answers is_crowded(std::ptrdiff_t here, const Ways& to,
                                            Answers edge) const {
    constexpr int least_alike = 2;
    // Of these eight, those that go another way.
    Answers others{};
    for (int d = 0; d < directions; ++d)
      if (steps_[d].bit != 0) others += to.ahead[d] + to.back[d];
    const Answers is_alone_or_nearly = (others < least_alike - 8) & edge;
    if (!any(is_alone_or_nearly)) return Answers{};
    const std::ptrdiff_t ring[] = {1,  1 + width_,  width_,  width_ - 1,
                                   -1, -1 - width_, -width_, 1 - width_};
    Answers turns{};
    Answers last = load<Answers>(path_ + here + ring[7]);
    for (const std::ptrdiff_t step : ring) {
      const Answers next = load<Answers>(path_ + here + step);
      turns += next != last;
      last = next;
    }
    // One that all others are alike around may be in a small disc.
    const Answers is_alone = bent_ == nullptr ? turns == 0 : Answers{};
    return is_alone_or_nearly & (is_alone | (turns < -4));
  }

  const Tile& tile_;
  const SearchRoom& room_;
  const std::ptrdiff_t width_, groups_;  // of a row
  const std::ptrdiff_t apart_;           // groups of the area
  const float* const path_;
  const float* const ends_;  // null: there are none
  const float* const bent_;  // null: every edge is seen
  Step steps_[directions];   // to one of each two opposite neighbours
};

template <std::size_t count, int reach>
std::size_t search(const Tile& tile, const SearchRoom& room) {
  return Search<count, reach>(tile, room).run();
}

}  // namespace
}  // namespace pse::antialias
