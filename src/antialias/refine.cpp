// One pixel's way: where is the nearest edge and is it the only one; how does it bend, and what
// lies beyond it; what is the program's value on either side. At the first doubt: more samples.
#include "antialias/refine.h"

#include <algorithm>
#include <cmath>

#include "antialias/derive.h"

namespace pse::antialias {

// A pixel with one edge under its kernel.
struct Refiner::Crossing {
  Pixel pixel;
  float distance;  // of the centre from the edge, positive on the side the normal points to
  float nx, ny;
  float bend = 0;   // how much the normal turns towards the tangent (-ny, nx) per pixel along it
  float share = 0;  // of the kernel on the normal's side
  float towards = 0, away = 0;  // to the middles of the sides, along the normal
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

// The distance x of a pixel from an edge, from what two places said of it: f / |f'| is `first` at
// the pixel, and `second` at `out` along the normal and s along the edge, which bends away by a
// parabola. Along the normal f is x + b x^2, so f / |f'| is x - b x^2; a bend measured off the edge
// is made that of the edge.
float true_distance(float first, float second, float out, float& bend, float s) {
  constexpr float least = 0.15f, most_b = 1, unseen = 0.001f;
  const float measured = bend;
  // Both say the same of a straight edge.
  if (std::abs(measured) < unseen && std::abs(second - out - first) < unseen) return first;
  float beside = second, x = first;
  for (int round = 0; round < 3; ++round) {
    bend = measured / std::max(1 - measured * beside, 0.5f);
    x = beside - out - bend * s * s / 2;
    const float b = std::abs(x) < least ? 0 : std::clamp((x - first) / (x * x), -most_b, most_b);
    beside = second + b * beside * beside;
  }
  return x;
}

}  // namespace

std::vector<Refiner::Crossing> Refiner::find_crossings(const std::vector<Pixel>& pixels,
                                                       std::vector<Unclear>& unclear, Work& work,
                                                       RunStatus& status) const {
  Places& places = work.places;
  places.clear();
  for (const Pixel& pixel : pixels) places.add(centre(pixel.x), centre(pixel.y));
  const Results& edges = edges_->run(work, status);
  const float reach = options_.filter.reach();
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Line first = line_of(edges, 0, i), second = line_of(edges, 1, i);
    if (!(std::abs(first.distance) <= std::max(farthest_explained, 2 * reach)) ||
        std::abs(second.distance) < reach)
      unclear.push_back({pixels[i], {first, second}});
    else if (std::abs(first.distance) < reach * 1.2f)
      crossings.push_back({pixels[i], first.distance, first.nx, first.ny});
  }
  return crossings;
}

// Looks at each edge again, a little along it and on its far side: how it bends, and whether there
// is another edge.
void Refiner::follow(std::vector<Crossing>& crossings, std::vector<Unclear>& unclear, Work& work,
                     RunStatus& status) const {
  const float reach = options_.filter.reach(), s = along * reach;
  Places& places = work.places;
  places.clear();
  std::vector<float> offsets;  // from the first guess of the edge along the normal
  for (const Crossing& c : crossings) {
    offsets.push_back(c.distance < 0 ? beyond * reach : -beyond * reach);
    const float out = offsets.back() - c.distance;
    places.add(centre(c.pixel.x) + double(out * c.nx - s * c.ny),
               centre(c.pixel.y) + double(out * c.ny + s * c.nx));
  }
  const Results& edges = edges_->run(work, status);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    Crossing c = crossings[i];
    Line line = line_of(edges, 0, i);
    const Line second = line_of(edges, 1, i);
    float cosine = line.nx * c.nx + line.ny * c.ny;
    if (cosine < 0) {
      cosine = -cosine;
      line = {-line.distance, -line.nx, -line.ny};
    }
    // The other line's distance from the pixel.
    const double dx = centre(c.pixel.x) - places.x[i], dy = centre(c.pixel.y) - places.y[i];
    const auto other = static_cast<float>(second.distance + second.nx * dx + second.ny * dy);
    const float turn = (line.ny * c.nx - line.nx * c.ny) / cosine;
    if (std::abs(other) < reach || !(std::abs(turn) < most_turn) ||
        !(std::abs(line.distance) < reach)) {
      unclear.push_back({c.pixel, {{c.distance, c.nx, c.ny}, {other, second.nx, second.ny}}});
      continue;
    }
    c.bend = turn / s;
    c.distance =
        true_distance(c.distance, line.distance / cosine, offsets[i] - c.distance, c.bend, s);
    if (std::abs(c.distance) >= options_.filter.reach(c.nx, c.ny)) continue;
    const float moment = options_.filter.moment(c.distance, c.nx, c.ny);
    const float straight = options_.filter.share(c.distance, c.nx, c.ny);
    // The parabola -bend y^2 / 2 for the line, to second order.
    const float turning = options_.filter.edge_moment(c.distance, c.nx, c.ny);
    c.share = straight + c.bend / 2 * turning * (1 - 0.75f * c.bend * c.distance);
    if (!(c.share > least_share && c.share < 1 - least_share)) continue;
    c.towards = moment / straight, c.away = -moment / (1 - straight);
    crossings[kept++] = c;
  }
  crossings.erase(crossings.begin() + static_cast<std::ptrdiff_t>(kept), crossings.end());
}

// LERP(share, one side, other side), each side where the kernel's weight on it has its middle: what
// changes evenly on a side then has exactly its mean.
void Refiner::blend(const Tile& tile, const std::vector<Crossing>& crossings, Refined& result,
                    std::vector<Unclear>& unclear, Work& work, RunStatus& status) const {
  Places& places = work.places;
  places.clear();
  for (const Crossing& c : crossings) {
    for (const float by : {c.towards, c.away})
      places.add(centre(c.pixel.x) + double(by * c.nx), centre(c.pixel.y) + double(by * c.ny));
  }
  const Results& sides = program_.run(work, status);
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& c = crossings[i];
    const std::size_t here = tile.at(c.pixel.x, c.pixel.y), a = 2 * i, b = a + 1;
    std::size_t own = c.distance < 0 ? b : a;
    // The sides must be two ways through the program, the pixel's own one of them.
    const float* path = sides[outputs_];
    // On which side a pixel lies whose middle is on the edge, rounding decides.
    if (std::abs(c.distance) < on_edge && path[own] != tile.path()[here]) own = own == a ? b : a;
    const bool one_way = path[a] == path[b], strange = path[own] != tile.path()[here];
    bool doubt = false;
    for (std::size_t o = 0; o < outputs_ && !doubt; ++o)
      doubt = (one_way && differ(sides[o][a], sides[o][b])) ||
              (strange && differ(sides[o][own], tile.planes[o][here]));
    if (doubt) {
      unclear.push_back({c.pixel});
      continue;
    }
    result.pixels.push_back(c.pixel);
    for (std::size_t o = 0; o < outputs_; ++o)
      result.values[o].push_back(sides[o][b] + c.share * (sides[o][a] - sides[o][b]));
  }
}

Refined Refiner::refine(const Tile& tile, Work& work, RunStatus& status, Counts& counts) const {
  std::vector<Pixel> pixels = find_edge_pixels(tile, options_.filter);
  Refined result({}, outputs_);
  if (pixels.empty()) return result;
  counts.filtered += static_cast<std::int64_t>(pixels.size());
  // The program knows the edges within objects, not those of the objects.
  const auto inner = std::ranges::stable_partition(
      pixels, [&](const Pixel& pixel) { return pixel.silhouette || edges_ == nullptr; });
  std::vector<Unclear> unclear;
  for (const Pixel& pixel : std::ranges::subrange(pixels.begin(), inner.begin()))
    unclear.push_back({pixel});
  pixels.erase(pixels.begin(), inner.begin());
  if (!pixels.empty()) {
    std::vector<Crossing> crossings = find_crossings(pixels, unclear, work, status);
    follow(crossings, unclear, work, status);
    blend(tile, crossings, result, unclear, work, status);
  }
  counts.blended += static_cast<std::int64_t>(result.pixels.size());
  counts.supersampled += static_cast<std::int64_t>(unclear.size());
  settle(unclear, result, work, status);
  return result;
}

}  // namespace pse::antialias
