// Small discs (refine.h): places around a pixel tell the middle, where their normals meet, and the
// radius, by f / |f'| as for a distance or for its square. Places on that circle then confirm it.
// 2002 chapter, "The High-Contrast Filter", whose edges are straight.
#include "antialias/circles.h"

#include <algorithm>
#include <cmath>

#include "antialias/refine.h"
#include "noise/math.h"

namespace pse::antialias {
namespace {

constexpr std::size_t looks = 3;
// How far from the pixel's centre it is looked from first, in reaches of the kernel.
constexpr float away = 0.7f;
// Normals meet, and radii are one, when they are off by less; in pixels.
constexpr float same_middle = 0.02f, same_radius = 0.008f;
// Of the radius: by how much the circle may still move when it is confirmed.
constexpr float settled = 0.03f;
constexpr int most_rounds = 3;

// What one place said, in pixels from the pixel's centre.
struct Look {
  float x, y;
  Line line;
};

// The circle that the normals point from or to; false where there is none.
bool meet(const std::array<Look, looks>& seen, Circle& circle) {
  // The middle: least squares of the distances from the normals.
  float xx = 0, xy = 0, yy = 0, bx = 0, by = 0;
  for (const auto& [x, y, line] : seen) {
    const float across = line.nx * y - line.ny * x;
    xx += line.ny * line.ny, yy += line.nx * line.nx, xy -= line.nx * line.ny;
    bx -= line.ny * across, by += line.nx * across;
  }
  constexpr float least_determinant = 0.02f;
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > least_determinant)) return false;
  circle.x = (bx * yy - by * xy) / determinant;
  circle.y = (by * xx - bx * xy) / determinant;

  std::array<float, looks> of_distance{}, of_square{};
  for (std::size_t k = 0; k < looks; ++k) {
    const auto& [x, y, line] = seen[k];
    const float dx = x - circle.x, dy = y - circle.y;
    const float along = line.nx * dx + line.ny * dy, across = line.nx * dy - line.ny * dx;
    if (!(std::abs(across) < same_middle)) return false;
    const bool grows = along > 0;
    if (k > 0 && grows != circle.grows) return false;
    circle.grows = grows;
    const float from_middle = std::sqrt(dx * dx + dy * dy);
    const float outside = grows ? line.distance : -line.distance;
    of_distance[k] = from_middle - outside;
    of_square[k] = std::sqrt(std::max(from_middle * (from_middle - 2 * outside), 0.0f));
  }
  const auto spread = [](const std::array<float, looks>& radii) {
    const auto [least, most] = std::ranges::minmax(radii);
    return most - least;
  };
  const bool is_square = std::ranges::min(of_square) > 0 && spread(of_square) < spread(of_distance);
  const auto& radii = is_square ? of_square : of_distance;
  circle.radius = (radii[0] + radii[1] + radii[2]) / looks;
  return circle.radius > 0;
}

// Places on the circle, as far apart as the kernel sees of it; as directions from its middle.
std::array<std::array<float, 2>, looks> directions(const Circle& circle, float reach) {
  const float a = std::sqrt(circle.x * circle.x + circle.y * circle.y);
  std::array<float, 2> to_pixel = {1, 0};
  float between = 2 * num::pi / 3;
  if (a > 1e-6f) {
    to_pixel = {-circle.x / a, -circle.y / a};
    const float r = circle.radius, cosine = (a * a + r * r - reach * reach) / (2 * a * r);
    constexpr float part = 0.7f;
    between = std::min(between, part * num::acos(std::clamp(cosine, -1.0f, 1.0f)));
  }
  const float c = num::cos(between), s = num::sin(between);
  const auto [x, y] = to_pixel;
  return {{{x, y}, {c * x - s * y, c * y + s * x}, {c * x + s * y, c * y - s * x}}};
}

// Moves the radius to what the places on the circle said of it; false where that is no circle.
bool confirm(const std::array<Look, looks>& seen, Circle& circle) {
  float sum = 0, least = no_edge, most = 0;
  for (const auto& [x, y, line] : seen) {
    const float out_x = (x - circle.x) / circle.radius, out_y = (y - circle.y) / circle.radius;
    const float cosine = line.nx * out_x + line.ny * out_y;
    constexpr float least_cosine = 0.97f;
    if (!((circle.grows ? cosine : -cosine) > least_cosine)) return false;
    const float radius = circle.radius - (circle.grows ? line.distance : -line.distance);
    sum += radius, least = std::min(least, radius), most = std::max(most, radius);
  }
  if (!(least > 0 && most - least < same_radius)) return false;
  circle.radius = sum / looks;
  return true;
}

}  // namespace

// The share and the sides of a circle.
CrossingLists::Edge Refiner::edge_of(const Circle& circle) const {
  const auto [x, y, radius, grows] = circle;
  const float a = std::sqrt(x * x + y * y);
  const float ux = a > 1e-6f ? -x / a : 1, uy = a > 1e-6f ? -y / a : 0;
  const Filter::Within in = options_.filter.within(x, y, radius);
  // The middles of both sides, from the pixel's centre away from the circle's: where the ring
  // around a disc has its middle within the disc, a place at its side.
  constexpr float beside = 0.05f, inmost = 0.97f;
  const float moment = in.x * ux + in.y * uy;
  const float inside =
      std::clamp(in.share > 0 ? moment / in.share : -a, -inmost * radius - a, inmost * radius - a);
  const float outside = std::max(in.share < 1 ? -moment / (1 - in.share) : 0, radius + beside - a);
  const float sign = grows ? 1 : -1;
  return {.distance = sign * (a - radius),
          .nx = sign * ux,
          .ny = sign * uy,
          .share = grows ? 1 - in.share : in.share,
          .towards = grows ? outside : -inside,
          .away = grows ? inside : -outside};
}

// Pixels of work.bent that have one circle's edge become crossings; of the others those are unclear
// whose kernel it reaches.
void Refiner::find_circles(CrossingLists& c, Work& work, RunStatus& status) const {
  const std::size_t count = work.bent.size();
  if (count == 0) return;
  const float reach = options_.filter.reach();
  struct Candidate {
    std::size_t pixel;
    Circle circle;
    std::array<Look, looks> seen;
  };
  std::vector<Candidate> open(count);
  for (std::size_t i = 0; i < count; ++i) {
    open[i].pixel = i;
    constexpr float turns[looks][2] = {{0.93f, 0.37f}, {-0.78f, 0.62f}, {-0.15f, -0.99f}};
    for (std::size_t k = 0; k < looks; ++k)
      open[i].seen[k].x = away * reach * turns[k][0],
      open[i].seen[k].y = away * reach * turns[k][1];
  }
  // Asks at the places of all; false where another edge is near, or none.
  const auto look = [&] {
    Places& places = work.places;
    places.resize(open.size() * looks);
    std::size_t at = 0;
    for (const Candidate& one : open)
      for (const Look& from : one.seen) {
        const Pixel& pixel = work.bent[one.pixel].pixel;
        places.x[at] = pixel.x + 0.5 + double(from.x);
        places.y[at++] = pixel.y + 0.5 + double(from.y);
      }
    const Results& edges = edges_->run(work, status);
    at = 0;
    for (Candidate& one : open)
      for (Look& from : one.seen) {
        from.line = {edges[0][at], edges[1][at], edges[2][at]};
        // Seen from the pixel's centre.
        const float other = edges[3][at] - edges[4][at] * from.x - edges[5][at] * from.y;
        if (std::abs(other) < reach) from.line = {no_edge, 0, 0};
        ++at;
      }
  };
  const auto add = [&](const Pixel& pixel, const CrossingLists::Edge& edge) {
    c.x[c.count] = pixel.x, c.y[c.count] = pixel.y;
    c.set(c.count, edge);
    c.count += CrossingLists::parts(edge.share) ? 1 : 0;
  };
  // An edge that could be followed is what it was.
  const auto give_up = [&](const Candidate& one) {
    const Bent& bent = work.bent[one.pixel];
    if (bent.is_followed)
      add(bent.pixel, bent.edge);
    else
      work.unclear.push_back({bent.pixel});
  };

  look();
  std::size_t kept = 0;
  for (Candidate& one : open)
    if (meet(one.seen, one.circle))
      open[kept++] = one;
    else
      give_up(one);
  open.resize(kept);
  for (int round = 0; round < most_rounds && !open.empty() && !status.stopped(); ++round) {
    for (Candidate& one : open) {
      const auto towards = directions(one.circle, reach);
      for (std::size_t k = 0; k < looks; ++k) {
        one.seen[k].x = one.circle.x + one.circle.radius * towards[k][0];
        one.seen[k].y = one.circle.y + one.circle.radius * towards[k][1];
      }
    }
    look();
    kept = 0;
    for (Candidate& one : open) {
      const float before = one.circle.radius;
      if (!confirm(one.seen, one.circle)) {
        give_up(one);
      } else if (std::abs(one.circle.radius - before) > settled * before) {
        if (round + 1 == most_rounds)
          give_up(one);
        else
          open[kept++] = one;
      } else {
        add(work.bent[one.pixel].pixel, edge_of(one.circle));
      }
    }
    open.resize(kept);
  }
}

}  // namespace pse::antialias
