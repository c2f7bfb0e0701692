// Normal equations of at most five unknowns, then Newton's method to the nearest place of value 0.
#include "antialias/fit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace pse::antialias {
namespace {

// The fit misses the neighbours by less than this much of the slope, root mean square.
constexpr double most_variance = 0.2;

// f(x, y) = c + a x + b y + (p x^2 + q y^2) / 2 + r x y.
struct Surface {
  double c = 0, a = 0, b = 0, p = 0, q = 0, r = 0;

  double at(double x, double y) const {
    return c + a * x + b * y + (p * x * x + q * y * y) / 2 + r * x * y;
  }
  std::array<double, 2> slope(double x, double y) const {
    return {a + p * x + r * y, b + q * y + r * x};
  }
};

using Row =
    std::array<double, 6>;  // of a system of up to five equations; the last is the right side

// Gauss's elimination; false where the equations do not tell.
bool solve(std::array<Row, 5>& rows, std::size_t count, std::array<double, 5>& unknowns) {
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < count; ++i)
      if (std::abs(rows[i][k]) > std::abs(rows[best][k])) best = i;
    if (!(std::abs(rows[best][k]) > 1e-6)) return false;
    std::swap(rows[k], rows[best]);
    for (std::size_t i = 0; i < count; ++i) {
      if (i == k) continue;
      const double factor = rows[i][k] / rows[k][k];
      for (std::size_t j = k; j < 6; ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  for (std::size_t k = 0; k < count; ++k) unknowns[k] = rows[k][5] / rows[k][k];
  return true;
}

// The best surface of `count` terms (2: a plane, 5: with bends) through the pixel's own value.
std::optional<Surface> best_surface(float here, const std::array<float, 8>& values, unsigned known,
                                    std::size_t count) {
  std::array<Row, 5> rows{};
  for (std::size_t i = 0; i < eight_around.size(); ++i) {
    if (!(known >> i & 1)) continue;
    const double x = eight_around[i][0], y = eight_around[i][1];
    const std::array<double, 5> terms = {x, y, x * x / 2, y * y / 2, x * y};
    const double difference = double(values[i]) - double(here);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t j = 0; j < count; ++j) rows[k][j] += terms[k] * terms[j];
      rows[k][5] += terms[k] * difference;
    }
  }
  std::array<double, 5> u{};
  if (!solve(rows, count, u)) return std::nullopt;
  return Surface{here, u[0], u[1], u[2], u[3], u[4]};
}

double variance(const Surface& surface, const std::array<float, 8>& values, unsigned known) {
  double sum = 0;
  for (std::size_t i = 0; i < eight_around.size(); ++i)
    if (known >> i & 1) {
      const double miss = surface.at(eight_around[i][0], eight_around[i][1]) - double(values[i]);
      sum += miss * miss;
    }
  return std::sqrt(sum / std::popcount(known));
}

}  // namespace

Fit fit_edge(float here, const std::array<float, 8>& values, unsigned known, const Filter& filter,
             FittedEdge& edge) {
  // The surface, with bends where all neighbours are there.
  std::optional<Surface> fitted = best_surface(here, values, known, known == 0xff ? 5 : 2);
  if (!fitted) return Fit::failed;
  const Surface& f = *fitted;
  const double size = std::hypot(f.a, f.b);
  if (!(variance(f, values, known) <= most_variance * size)) return Fit::failed;

  // The nearest place where it is 0. Far from a straight line nothing is said of it.
  const double reach = filter.reach();
  double x = 0, y = 0;
  std::array<double, 2> g = {f.a, f.b};
  for (int round = 0; round < 6; ++round) {
    const double square = g[0] * g[0] + g[1] * g[1];
    const double step = f.at(x, y) / square;
    x -= step * g[0], y -= step * g[1];
    if (!(std::hypot(x, y) < 3 * reach + 1)) return Fit::none;
    g = f.slope(x, y);
  }
  const double length = std::hypot(g[0], g[1]);
  if (!(length > 0.1 * size)) return Fit::failed;
  const double nx = g[0] / length, ny = g[1] / length;
  const double distance = -(x * nx + y * ny);
  // How the slope turns along the edge.
  const double bend = (f.p * ny * ny - 2 * f.r * nx * ny + f.q * nx * nx) / length;

  edge.distance = static_cast<float>(distance);
  edge.nx = static_cast<float>(nx), edge.ny = static_cast<float>(ny);
  edge.bend = static_cast<float>(bend);
  if (!(std::abs(distance) < reach)) return Fit::none;
  const float straight = filter.share(edge.distance, edge.nx, edge.ny);
  const float moment = filter.moment(edge.distance, edge.nx, edge.ny);
  edge.share = std::clamp(
      straight + edge.bend / 2 * moment * (1 - 0.75f * edge.bend * edge.distance), 0.0f, 1.0f);
  for (std::size_t i = 0; i < eight_around.size(); ++i)
    edge.distances[i] =
        static_cast<float>(distance + eight_around[i][0] * nx + eight_around[i][1] * ny);
  return Fit::edge;
}

}  // namespace pse::antialias
