// One pixel's way: where is the nearest edge and is it the only one; how does it bend, and what
// lies beyond it; what is the program's value on either side. At the first doubt: more samples.
#include "antialias/refine.h"

#include <algorithm>
#include <cmath>

#include "antialias/derive.h"
#include "antialias/path.h"
#include "antialias/steps.h"

namespace pse::antialias {
namespace {

// Where no program ran there is no normal, and no line.
Line line_of(const Results& edges, std::size_t which, std::size_t i) {
  const Line line{edges[3 * which][i], edges[3 * which + 1][i], edges[3 * which + 2][i]};
  return line.nx == 0 && line.ny == 0 ? Line{no_edge, 1, 0} : line;
}

// Where two neighbours differ an edge lies between them, so within this of either.
constexpr float farthest_explained = 1.7f;
// A pixel's middle is on an edge as near as this; and nearer, it may have a way of its own, of
// those that differ in the last bit.
constexpr float on_edge = 0.01f, within_edge = 0.0005f;
// An edge that bends by more than this, times the kernel's reach, is taken for a circle where the
// kernel is not round.
constexpr float least_turn = 0.1f;
// By more than this, it is looked at from more places.
constexpr float most_turn = 0.2f;

constexpr CrossingLists::Edge out_of_reach = {.share = 1};

// Edges that bend look farther than they are from inside, the more so the nearer the middle is: the
// slope of a squared distance is 0 there. Within this many reaches they are followed.
float farthest_bent(float reach) {
  const float reaches = reach > usual_reach ? 2.0f : reach > 0.6f ? 1.7f : 1.2f;
  return reaches * reach;
}

}  // namespace

// Of the pixels, those with one edge within reach stay.
void Refiner::find_crossings(CrossingLists& c, bool may_bend, Work& work, RunStatus& status) const {
  Places& places = work.places;
  places.resize(c.count);
  for (std::size_t i = 0; i < c.count; ++i) places.x[i] = c.x[i] + 0.5, places.y[i] = c.y[i] + 0.5;
  const Results& edges = edges_->run(work, status);
  const float reach = options_.filter.reach(), farthest = std::max(farthest_explained, 2 * reach);
  const std::size_t room = c.count + CrossingLists::beyond;
  if (work.flags.size() < 6 * room) work.flags.resize(8 * room);
  auto* const nearness = reinterpret_cast<Nearness*>(work.flags.data());
  std::int32_t* const fates = work.flags.data() + room;
  steps().see_nearness(c, edges.lists(), reach, farthest, nearness);
  steps().find_fates(c, edges.lists(), nearness,
                     {reach, farthest, may_bend ? farthest_bent(reach) : 0}, fates);
  // Which fate is by chance: lists instead of branches.
  std::int32_t *const kept = fates + room, *const unclear = kept + room,
                      *const bent = unclear + room, *const between = bent + room;
  std::size_t all_kept = 0, all_unclear = 0, all_bent = 0, all_between = 0;
  for (std::size_t i = 0; i < c.count; ++i) {
    const std::int32_t fate = fates[i], number = static_cast<std::int32_t>(i);
    kept[all_kept] = unclear[all_unclear] = bent[all_bent] = between[all_between] = number;
    all_kept += (fate & to_follow) != 0, all_unclear += (fate & to_sample) != 0;
    all_bent += (fate & to_fit) != 0, all_between += (fate & to_smooth) != 0;
  }
  for (std::size_t k = 0; k < all_unclear; ++k) {
    const auto i = static_cast<std::size_t>(unclear[k]);
    work.unclear.push_back({c.pixel(i), {line_of(edges, 0, i), line_of(edges, 1, i)}});
  }
  for (std::size_t k = 0; k < all_bent; ++k) {
    const auto i = static_cast<std::size_t>(bent[k]);
    // What is out of reach and no circle stays so.
    if (nearness[i] == Nearness::unclear)
      work.bent.push_back({c.pixel(i)});
    else
      work.bent.push_back({c.pixel(i), true, out_of_reach});
  }
  for (std::size_t k = 0; k < all_between; ++k)
    work.between.push_back(c.pixel(static_cast<std::size_t>(between[k])));
  for (std::size_t k = 0; k < all_kept; ++k) {
    const auto i = static_cast<std::size_t>(kept[k]);
    c.x[k] = c.x[i], c.y[k] = c.y[i];
    c.distance[k] = edges[0][i], c.nx[k] = edges[1][i], c.ny[k] = edges[2][i];
    c.hidden[k] = c.hidden[i], c.unseen[k] = c.unseen[i], c.enclosed[k] = c.enclosed[i];
  }
  c.count = all_kept;
}

// Looks at each edge again, a little along it and on its far side: how it bends, and whether there
// is another edge.
void Refiner::follow(CrossingLists& c, bool may_bend, Work& work, RunStatus& status) const {
  const float reach = options_.filter.reach();
  Places& places = work.places;
  places.resize(c.count);
  steps().find_second_looks(c, reach, places.x.data(), places.y.data());
  const Results& edges = edges_->run(work, status);
  steps().look_again(c, edges.lists(), reach);
  settle_shares(c);

  const float most_bend = most_turn / reach;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < c.count; ++i) {
    const bool is_hidden = c.hidden[i] != 0;
    if (may_bend && c.is_one[i] == 0 && !is_hidden && !(std::abs(c.other[i]) < reach)) {
      work.bent.push_back({c.pixel(i)});
    } else if (c.is_one[i] == 0 || (is_hidden && std::abs(c.other[i]) < farthest_explained)) {
      const Line second = line_of(edges, 1, i);
      work.unclear.push_back({c.pixel(i), {c.line(i), {c.other[i], second.nx, second.ny}}});
    }
    const float share = c.share[i];
    const bool is_one = c.is_one[i] != 0 && !is_hidden;
    const bool is_circle =
        may_bend && is_one && (std::abs(c.bend[i]) > most_bend || c.enclosed[i] != 0);
    if (is_circle) work.bent.push_back({c.pixel(i), true, c.edge(i)});
    c.move(i, kept);
    kept += is_one & !is_circle & CrossingLists::parts(share);
  }
  c.count = kept;
}

// How the edges part the kernel.
void Refiner::settle_shares(const CrossingLists& c) const {
  const std::size_t count = (c.count + 3) / 4 * 4;
  options_.filter.measure({c.distance, count}, {c.nx, count}, {c.ny, count},
                          {{c.share, count}, {c.towards, count}, {c.turning, count}});
  steps().bend_shares(c);
  if (options_.filter.is_round()) return;
  const float least_bend = least_turn / options_.filter.reach();
  for (std::size_t i = 0; i < c.count; ++i) {
    const float bend = c.bend[i];
    if (!(std::abs(bend) > least_bend) || c.is_one[i] == 0) continue;
    const float to_middle = c.distance[i] + 1 / bend;
    c.set(i, edge_of({.x = -c.nx[i] * to_middle,
                      .y = -c.ny[i] * to_middle,
                      .radius = 1 / std::abs(bend),
                      .grows = bend > 0}));
  }
}

// LERP(share, one side, other side), each side where the kernel's weight on it has its middle: what
// changes evenly on a side then has exactly its mean.
void Refiner::blend(const Tile& tile, const CrossingLists& c, Refined& result, Work& work,
                    RunStatus& status) const {
  const std::size_t count = c.count;
  Places& places = work.places;
  places.resize(2 * count);
  steps().find_sides(c, places.x.data(), places.y.data());
  const Results& sides = program_.run(work, status);
  result.resize(count);
  for (std::size_t o = 0; o < outputs_; ++o) {
    const float *a = sides[o], *b = a + count;
    float* to = result.values[o].data();
    for (std::size_t i = 0; i < count; ++i) to[i] = b[i] + c.share[i] * (a[i] - b[i]);
  }

  // The sides must be two ways through the program, the pixel's own one of them.
  const float *path_a = sides[outputs_], *path_b = path_a + count;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t here = tile.at(c.x[i], c.y[i]);
    const float path = tile.path()[here];
    const bool is_a = path_a[i] == path, is_b = path_b[i] == path;
    bool on_a = !(c.distance[i] < 0);
    // On which side a pixel lies whose middle is on the edge, rounding decides.
    if (std::abs(c.distance[i]) < on_edge && !(on_a ? is_a : is_b)) on_a = !on_a;
    const bool one_way = path_a[i] == path_b[i];
    const bool strange = !(on_a ? is_a : is_b) && !(std::abs(c.distance[i]) < within_edge);
    bool doubt = false;
    if (one_way | strange)
      for (std::size_t o = 0; o < outputs_ && !doubt; ++o) {
        const float a = sides[o][i], b = sides[o][count + i];
        doubt =
            (one_way && differ(a, b)) || (strange && differ(on_a ? a : b, tile.planes[o][here]));
      }
    if (doubt) {
      work.unclear.push_back({{c.x[i], c.y[i]}});
      continue;
    }
    result.pixels[kept] = {c.x[i], c.y[i]};
    if (kept < i)
      for (auto& plane : result.values) plane[kept] = plane[i];
    ++kept;
  }
  result.resize(kept);
}

// Pixels between the bends of a steep ramp, with no edge under the kernel: the mean of what bends
// evenly is that of the middle and half of its bend times the kernel's variance.
void Refiner::smooth(const Tile& tile, const Work& work, Refined& result) const {
  const float part = options_.filter.variance() / 2;
  constexpr int jumps = (1 << bits_of_jumps) - 1;
  for (const Pixel& pixel : work.between) {
    const std::size_t here = tile.at(pixel.x, pixel.y);
    const auto row = static_cast<std::size_t>(tile.area.width());
    const std::array<std::size_t, 4> around = {here - 1, here + 1, here - row, here + row};
    const auto way = [&](std::size_t at) { return static_cast<int>(tile.path()[at]) & jumps; };
    const auto goes_along = [&](std::size_t at) { return way(at) == way(here); };
    if (!std::ranges::all_of(around, goes_along)) continue;
    result.pixels.push_back(pixel);
    for (std::size_t o = 0; o < outputs_; ++o) {
      const float* plane = tile.planes[o];
      float bend = 0;
      for (const std::size_t at : around) bend += plane[at] - plane[here];
      result.values[o].push_back(plane[here] + part * bend);
    }
  }
}

Refined Refiner::refine(const Tile& tile, Work& work, RunStatus& status, Counts& counts) const {
  const std::span<const Pixel> found = find_edge_pixels(tile, options_.filter, work.found);
  const std::span<const Pixel> fine = find_fine_pixels(tile, work.fine);
  Refined result({}, outputs_);
  if (found.empty() && fine.empty()) return result;
  counts.filtered += static_cast<std::int64_t>(found.size() + fine.size());
  result.reserve(found.size() + fine.size());
  work.unclear.clear(), work.bent.clear(), work.between.clear();
  work.noisy.clear(), work.halved.clear();
  CrossingLists inner = work.crossings.lists(found.size());
  const auto is_before = [](const Pixel& a, const Pixel& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  const auto add_fine = [&](const Pixel& pixel) {
    if (half_means_ && pixel.grain != Grain::fine)
      work.halved.push_back(pixel);
    else if (pixel.grain != Grain::none)
      work.noisy.push_back(pixel);
  };
  auto next = fine.begin();
  for (const Pixel& pixel : found) {
    while (next != fine.end() && is_before(*next, pixel)) add_fine(*next++);
    if (next != fine.end() && !is_before(pixel, *next)) {
      --counts.filtered;
      if ((next++)->grain != Grain::none) {
        // What an edge parts is not clear either.
        work.unclear.push_back({{.x = pixel.x, .y = pixel.y, .silhouette = pixel.silhouette}});
        continue;
      }
    }
    if ((pixel.hidden || pixel.unseen) && edges_ == nullptr) continue;
    inner.x[inner.count] = pixel.x, inner.y[inner.count] = pixel.y;
    inner.hidden[inner.count] = pixel.hidden ? 1 : 0;
    inner.jumps[inner.count] = pixel.jumps;
    inner.unseen[inner.count] = pixel.unseen ? 1 : 0;
    inner.enclosed[inner.count] = pixel.enclosed ? 1 : 0;
    // The program knows the edges within objects, not those of the objects.
    if (pixel.silhouette || (pixel.narrow && !pixel.hidden && !pixel.unseen) || pixel.untold ||
        edges_ == nullptr)
      work.unclear.push_back({pixel});
    else
      ++inner.count;
  }
  std::for_each(next, fine.end(), add_fine);
  if (inner.count > 0) {
    const bool may_bend = tile.bent != nullptr;
    find_crossings(inner, may_bend, work, status);
    follow(inner, may_bend, work, status);
    find_circles(inner, work, status);
    blend(tile, inner, result, work, status);
  }
  counts.blended += static_cast<std::int64_t>(result.pixels.size());
  smooth(tile, work, result);
  settle(tile, result, counts, work, status);
  settle_halves(tile, result, counts, work, status);
  settle_noise(result, counts, work, status);
  return result;
}

}  // namespace pse::antialias
