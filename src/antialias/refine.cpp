// One pixel's way: where is the nearest edge and is it the only one; how does it bend, and what
// lies beyond it; what is the program's value on either side. At the first doubt: more samples.
#include "antialias/refine.h"

#include <algorithm>
#include <cmath>

#include "antialias/derive.h"
#include "antialias/lanes.h"

namespace pse::antialias {

// Pixels with one edge under their kernels: numbers i of all lists belong together. The lists of
// numbers are as long as the next multiple of four says; what lies behind the pixels has no
// meaning.
struct Refiner::Crossings {
  std::vector<Pixel> pixels;
  // Of the centre from the edge, positive on the side the normal points to.
  std::vector<float> distance;
  std::vector<float> nx, ny;
  // How much the normal turns towards the tangent (-ny, nx) per pixel along it.
  std::vector<float> bend;
  std::vector<float> share;          // of the kernel on the normal's side
  std::vector<float> towards, away;  // to the middles of the sides, along the normal

  std::size_t size() const { return pixels.size(); }
  // Room in all lists for one number for each pixel.
  void make_room() {
    const std::size_t count = (size() + four - 1) / four * four;
    for (auto* list : {&distance, &nx, &ny, &bend, &share, &towards, &away}) list->resize(count);
  }
  Line line(std::size_t i) const { return {distance[i], nx[i], ny[i]}; }
  // Moves the pixel `from` to `to`.
  void move(std::size_t from, std::size_t to) {
    pixels[to] = pixels[from];
    for (auto* list : {&distance, &nx, &ny, &bend, &share, &towards, &away})
      (*list)[to] = (*list)[from];
  }
};

namespace {

double centre(int pixel) { return pixel + 0.5; }

// Where no program ran there is no normal, and no line.
Line line_of(const Results& edges, std::size_t which, std::size_t i) {
  const Line line{edges[3 * which][i], edges[3 * which + 1][i], edges[3 * which + 2][i]};
  return line.nx == 0 && line.ny == 0 ? Line{no_edge, 1, 0} : line;
}

// Where two neighbours differ an edge lies between them, so within this of either.
constexpr float farthest_explained = 1.7f;
// How far along the edge, and beyond it, it is looked at again; in reaches of the kernel.
constexpr float along = 0.7f, beyond = 0.1f;
// Edges that turn by more than this from one to the other look are not followed.
constexpr float most_turn = 0.5f;
// A pixel's middle is on an edge as near as this.
constexpr float on_edge = 0.01f;
// A share so near to 0 or 1 leaves the pixel as it is.
constexpr float least_share = 0.001f;

// The distances x of pixels from an edge, from what two places said of it: f / |f'| is `first` at
// the pixel, and `second` at `out` along the normal and s along the edge, which bends away by a
// parabola. Along the normal f is x + b x^2, so f / |f'| is x - b x^2; a bend measured off the edge
// is made that of the edge.
Four true_distance(Four first, Four second, Four out, Four& bend, float s) {
  constexpr float least = 0.15f, most_b = 1, unseen = 0.001f;
  const Four measured = bend;
  Four beside = second, x = first;
  for (int round = 0; round < 3; ++round) {
    bend = measured / larger(1 - measured * beside, Four{} + 0.5f);
    x = beside - out - bend * (s * s / 2);
    const Four b = choose(size(x) < least, Four{}, clamped((x - first) / (x * x), -most_b, most_b));
    beside = second + b * beside * beside;
  }
  // Both say the same of a straight edge.
  const AnswersOf<Four> is_straight =
      (size(measured) < unseen) & (size(second - out - first) < unseen);
  bend = choose(is_straight, measured, bend);
  return choose(is_straight, first, x);
}

}  // namespace

Refiner::Crossings Refiner::find_crossings(const std::vector<Pixel>& pixels,
                                           std::vector<Unclear>& unclear, Work& work,
                                           RunStatus& status) const {
  Places& places = work.places;
  places.clear();
  for (const Pixel& pixel : pixels) places.add(centre(pixel.x), centre(pixel.y));
  const Results& edges = edges_->run(work, status);
  const float reach = options_.filter.reach(), farthest = std::max(farthest_explained, 2 * reach);
  Crossings crossings;
  crossings.pixels = pixels;
  crossings.make_room();
  std::size_t count = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Line first = line_of(edges, 0, i), second = line_of(edges, 1, i);
    const float nearest = std::abs(first.distance);
    if (!(nearest <= farthest) || std::abs(second.distance) < reach) {
      unclear.push_back({pixels[i], {first, second}});
    } else if (nearest < reach * 1.2f) {
      crossings.pixels[count] = pixels[i];
      crossings.distance[count] = first.distance;
      crossings.nx[count] = first.nx, crossings.ny[count] = first.ny;
      ++count;
    }
  }
  crossings.pixels.resize(count);
  crossings.make_room();
  return crossings;
}

// Looks at each edge again, a little along it and on its far side: how it bends, and whether there
// is another edge.
void Refiner::follow(Crossings& crossings, std::vector<Unclear>& unclear, Work& work,
                     RunStatus& status) const {
  const float reach = options_.filter.reach(), s = along * reach;
  const std::size_t count = crossings.size();
  Places& places = work.places;
  places.x.resize(count), places.y.resize(count);
  // From the first guess of the edge along the normal.
  const auto offset = [&](auto distance) {
    return distance < 0 ? decltype(distance){} + beyond * reach
                        : decltype(distance){} - beyond * reach;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Line c = crossings.line(i);
    const float out = offset(c.distance) - c.distance;
    places.x[i] = centre(crossings.pixels[i].x) + double(out * c.nx - s * c.ny);
    places.y[i] = centre(crossings.pixels[i].y) + double(out * c.ny + s * c.nx);
  }
  const Results& edges = edges_->run(work, status);

  // Four edges at once; where the answer is no, there is more than one bent line.
  std::vector<float> others(crossings.distance.size());
  std::vector<std::int32_t> is_one(others.size());
  for (std::size_t i = 0; i < count; i += four) {
    const Four nx = load<Four>(&crossings.nx[i]), ny = load<Four>(&crossings.ny[i]);
    const Four first = load<Four>(&crossings.distance[i]);
    const Four out = offset(first) - first;
    const Four x = load<Four>(edges[1] + i), y = load<Four>(edges[2] + i);
    const Four cosine = x * nx + y * ny, turned = choose(cosine < 0, Four{} - 1, Four{} + 1);
    const Four turn = (y * nx - x * ny) / cosine;
    const Four beside = load<Four>(edges[0] + i) * turned;
    // The other line's distance from the pixel.
    const Four dx = s * ny - out * nx, dy = -(s * nx) - out * ny;
    const Four other =
        load<Four>(edges[3] + i) + load<Four>(edges[4] + i) * dx + load<Four>(edges[5] + i) * dy;
    const AnswersOf<Four> one =
        (size(turn) < most_turn) & (size(beside) < reach) & ~(size(other) < reach);
    Four bend = turn / s;
    store(&crossings.distance[i], true_distance(first, beside / size(cosine), out, bend, s));
    store(&crossings.bend[i], bend);
    store(&others[i], other);
    store(&is_one[i], one);
  }
  settle_shares(crossings);

  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Line c = crossings.line(i);
    if (is_one[i] == 0) {
      const Line second = line_of(edges, 1, i);
      unclear.push_back({crossings.pixels[i], {c, {others[i], second.nx, second.ny}}});
      continue;
    }
    const float share = crossings.share[i];
    if (share > least_share && share < 1 - least_share) crossings.move(i, kept++);
  }
  crossings.pixels.resize(kept);
}

// How the edges part the kernel.
void Refiner::settle_shares(Crossings& c) const {
  std::vector<float> turning(c.distance.size());
  options_.filter.measure(c.distance, c.nx, c.ny, {c.share, c.towards, turning});
  for (std::size_t i = 0; i < c.share.size(); i += four) {
    const Four straight = load<Four>(&c.share[i]), moment = load<Four>(&c.towards[i]);
    const Four bend = load<Four>(&c.bend[i]), distance = load<Four>(&c.distance[i]);
    // The parabola -bend y^2 / 2 for the line, to second order.
    const Four share =
        straight + bend / 2 * load<Four>(&turning[i]) * (1 - 0.75f * bend * distance);
    // An edge that is out of reach parts nothing.
    const AnswersOf<Four> is_whole = (straight <= 0) | (straight >= 1);
    store(&c.share[i], choose(is_whole, straight, share));
    store(&c.towards[i], moment / straight);
    store(&c.away[i], -moment / (1 - straight));
  }
}

// LERP(share, one side, other side), each side where the kernel's weight on it has its middle: what
// changes evenly on a side then has exactly its mean.
void Refiner::blend(const Tile& tile, const Crossings& crossings, Refined& result,
                    std::vector<Unclear>& unclear, Work& work, RunStatus& status) const {
  const std::size_t count = crossings.size();
  Places& places = work.places;
  places.x.resize(2 * count), places.y.resize(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Line c = crossings.line(i);
    const double x = centre(crossings.pixels[i].x), y = centre(crossings.pixels[i].y);
    for (std::size_t side = 0; side < 2; ++side) {
      const float by = side == 0 ? crossings.towards[i] : crossings.away[i];
      places.x[2 * i + side] = x + double(by * c.nx),
                       places.y[2 * i + side] = y + double(by * c.ny);
    }
  }
  const Results& sides = program_.run(work, status);
  const std::size_t start = result.pixels.size();
  result.resize(start + count);
  std::size_t kept = start;
  for (std::size_t i = 0; i < count; ++i) {
    const Pixel& pixel = crossings.pixels[i];
    const float distance = crossings.distance[i], share = crossings.share[i];
    const std::size_t here = tile.at(pixel.x, pixel.y), a = 2 * i, b = a + 1;
    std::size_t own = distance < 0 ? b : a;
    // The sides must be two ways through the program, the pixel's own one of them.
    const float* path = sides[outputs_];
    // On which side a pixel lies whose middle is on the edge, rounding decides.
    if (std::abs(distance) < on_edge && path[own] != tile.path()[here]) own = own == a ? b : a;
    const bool one_way = path[a] == path[b], strange = path[own] != tile.path()[here];
    bool doubt = false;
    for (std::size_t o = 0; o < outputs_ && (one_way || strange) && !doubt; ++o)
      doubt = (one_way && differ(sides[o][a], sides[o][b])) ||
              (strange && differ(sides[o][own], tile.planes[o][here]));
    if (doubt) {
      unclear.push_back({pixel});
      continue;
    }
    result.pixels[kept] = pixel;
    for (std::size_t o = 0; o < outputs_; ++o)
      result.values[o][kept] = sides[o][b] + share * (sides[o][a] - sides[o][b]);
    ++kept;
  }
  result.resize(kept);
}

Refined Refiner::refine(const Tile& tile, Work& work, RunStatus& status, Counts& counts) const {
  const std::span<const Pixel> found = find_edge_pixels(tile, options_.filter, work.found);
  Refined result({}, outputs_);
  if (found.empty()) return result;
  counts.filtered += static_cast<std::int64_t>(found.size());
  std::vector<Pixel> inner;
  std::vector<Unclear> unclear;
  for (const Pixel& pixel : found) {
    // The program knows the edges within objects, not those of the objects.
    if (pixel.silhouette || pixel.narrow || pixel.untold || edges_ == nullptr)
      unclear.push_back({pixel});
    else
      inner.push_back(pixel);
  }
  if (!inner.empty()) {
    Crossings crossings = find_crossings(inner, unclear, work, status);
    follow(crossings, unclear, work, status);
    blend(tile, crossings, result, unclear, work, status);
  }
  counts.blended += static_cast<std::int64_t>(result.pixels.size());
  settle(tile, unclear, result, counts, work, status);
  return result;
}

}  // namespace pse::antialias
