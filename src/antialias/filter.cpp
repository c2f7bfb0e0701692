// Closed forms, kernel by kernel. All transcendental functions are pse's own, so that pictures are
// the same on every machine.
#include "antialias/filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "antialias/lanes.h"
#include "noise/math.h"

namespace pse::antialias {
namespace {

constexpr float pi = 3.14159265358979f;
constexpr float deviation = 0.5f;    // of the Gauss kernel
constexpr float gauss_reach = 2.0f;  // four deviations; what lies beyond weighs 6e-5

float root(float a) { return std::sqrt(std::max(a, 0.0f)); }
// Only for a in (0, 1].
float acosh_of_inverse(float a) { return num::log((1 + root(1 - a * a)) / a); }

// The integral of the normal distribution up to x (Abramowitz and Stegun 7.1.26, error 1.5e-7).
float normal_integral(float x) {
  const float z = std::abs(x) * 0.70710678f;
  const float t = 1 / (1 + 0.3275911f * z);
  const float sum =
      t * (0.254829592f +
           t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
  const float tail = 0.5f * sum * num::exp(-z * z);
  return x < 0 ? tail : 1 - tail;
}

// Of the chapter's kernel, of radius 1/2. V: a number or four.
template <class V>
V cubic_share(V d) {
  const V t = clamped(d + 0.5f, 0, 1);
  return t * t * (3 - 2 * t);
}
template <class V>
V cubic_moment(V d) {
  const V square = larger(0.25f - d * d, V{});
  return 1.5f * square * square;
}

// The larger and the smaller of |nx| and |ny|.
std::pair<float, float> sides(float nx, float ny) {
  const float x = std::abs(nx), y = std::abs(ny);
  return {std::max(x, y), std::min(x, y)};
}

// The square's projection on the normal is a trapezium: flat up to k, nothing from h on.
float box_share(float d, float nx, float ny) {
  const auto [a, b] = sides(nx, ny);
  const float h = (a + b) / 2, k = (a - b) / 2;
  if (d <= -h) return 0;
  if (d >= h) return 1;
  if (d < -k) return (d + h) * (d + h) / (2 * a * b);
  if (d > k) return 1 - (h - d) * (h - d) / (2 * a * b);
  return 0.5f + d / a;
}

float box_moment(float d, float nx, float ny) {
  const auto [a, b] = sides(nx, ny);
  const float h = (a + b) / 2, k = (a - b) / 2;
  const auto slope = [&, a = a, b = b](float from) {
    return b < 1e-6f ? 0 : (h * h * h / 6 - h * from * from / 2 + from * from * from / 3) / (a * b);
  };
  return d < k ? (k * k - d * d) / (2 * a) + slope(k) : slope(d);
}

// The angle and distance of a point of a disc of radius 1 for one of the square, concentric squares
// to circles: points that are well spread stay so. The distance is the root of a uniform number.
std::pair<float, float> disc_place(float u, float v) {
  const float a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {0.0f, 0.0f};
  if (std::abs(a) > std::abs(b)) return {a, pi / 4 * (b / a)};
  return {b, pi / 2 - pi / 4 * (a / b)};
}

}  // namespace

std::optional<FilterKind> filter_named(std::string_view name) {
  using enum FilterKind;
  static constexpr std::array<std::pair<std::string_view, FilterKind>, 6> names = {
      {{"cubic", cubic},
       {"box", box},
       {"disc", disc},
       {"cone", cone},
       {"paraboloid", paraboloid},
       {"gauss", gauss}}};
  for (const auto& [known, kind] : names)
    if (known == name) return kind;
  return std::nullopt;
}

float Filter::reach(float nx, float ny) const {
  switch (kind_) {
    case FilterKind::cubic:
      return 0.5f * scale_;
    case FilterKind::box:
      return 0.5f * (std::abs(nx) + std::abs(ny)) * scale_;
    case FilterKind::gauss:
      return gauss_reach * scale_;
    default:
      return scale_;
  }
}

float Filter::reach() const {
  return kind_ == FilterKind::box ? 0.70710678f * scale_ : reach(1, 0);
}

float Filter::variance() const {
  const auto of_unit = [&]() -> float {
    switch (kind_) {
      case FilterKind::cubic:
        return 1.0f / 20;
      case FilterKind::box:
        return 1.0f / 12;
      case FilterKind::disc:
        return 1.0f / 4;
      case FilterKind::cone:
        return 3.0f / 20;
      case FilterKind::paraboloid:
        return 1.0f / 6;
      default:
        return deviation * deviation;
    }
  };
  return of_unit() * scale_ * scale_;
}

Filter::FourthMoments Filter::fourth_moments() const {
  const auto of_unit = [&]() -> float {
    switch (kind_) {
      case FilterKind::cubic:
        return 3.0f / 560;
      case FilterKind::box:
        return 1.0f / 80;
      case FilterKind::disc:
        return 1.0f / 8;
      case FilterKind::cone:
        return 3.0f / 56;
      case FilterKind::paraboloid:
        return 1.0f / 16;
      default:
        return 3 * deviation * deviation * deviation * deviation;
    }
  };
  const float along = of_unit() * scale_ * scale_ * scale_ * scale_;
  // Of round kernels it is a third; the square's axes know nothing of each other.
  return {along, kind_ == FilterKind::box ? variance() * variance() : along / 3};
}

float Filter::share(float distance, float nx, float ny) const {
  const float reach_here = reach(nx, ny), d = distance / scale_;
  if (distance <= -reach_here) return 0;
  if (distance >= reach_here) return 1;
  const float s = root(1 - d * d), t = std::abs(d);
  switch (kind_) {
    case FilterKind::cubic:
      return cubic_share(d);
    case FilterKind::box:
      return box_share(d, nx, ny);
    case FilterKind::disc:
      return 0.5f + (d * s + num::asin(d)) / pi;
    case FilterKind::paraboloid:
      return 0.5f + (d * (5 - 2 * d * d) * s + 3 * num::asin(d)) / (3 * pi);
    case FilterKind::cone: {
      const float cube = t < 1e-6f ? 0 : t * t * t * acosh_of_inverse(t);
      const float half = (2 * t * s + num::asin(t) - cube) / pi;
      return d < 0 ? 0.5f - half : 0.5f + half;
    }
    default:
      return normal_integral(d / deviation);
  }
}

float Filter::moment(float distance, float nx, float ny) const {
  const float d = std::abs(distance) / scale_;
  if (std::abs(distance) >= reach(nx, ny)) return 0;
  const float square = std::max(1 - d * d, 0.0f), s = root(square);
  const auto of_unit = [&]() -> float {
    switch (kind_) {
      case FilterKind::cubic:
        return cubic_moment(d);
      case FilterKind::box:
        return box_moment(d, nx, ny);
      case FilterKind::disc:
        return 2 / (3 * pi) * square * s;
      case FilterKind::paraboloid:
        return 8 / (15 * pi) * square * square * s;
      case FilterKind::cone: {
        const float fourth = d < 1e-6f ? 0 : d * d * d * d * acosh_of_inverse(d);
        return 3 / pi * (s * square / 3 + fourth / 4 - (s - s * square / 3) / 4);
      }
      default:
        return deviation / root(2 * pi) * num::exp(-d * d / (2 * deviation * deviation));
    }
  };
  return of_unit() * scale_;
}

float Filter::edge_moment(float distance, float nx, float ny) const {
  if (kind_ != FilterKind::box) return moment(distance, nx, ny);
  // The edge's points -d n + t (-ny, nx) in the square of side 1: t from `low` to `high`.
  const float d = distance / scale_;
  float low = -1, high = 1;
  const auto clip = [&](float start, float slope) {
    if (std::abs(slope) < 1e-6f) return;
    const float a = (-0.5f - start) / slope, b = (0.5f - start) / slope;
    low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
  };
  clip(-d * nx, -ny);
  clip(-d * ny, nx);
  if (!(low < high)) return 0;
  return (high * high * high - low * low * low) / 3 * scale_;
}

void Filter::measure(std::span<const float> d, std::span<const float> nx, std::span<const float> ny,
                     const Measures& measures) const {
  const auto& [shares, moments, edge_moments] = measures;
  if (kind_ == FilterKind::cubic) {
    for (std::size_t i = 0; i < d.size(); i += four) {
      const Four distance = load<Four>(&d[i]) / scale_, moment = cubic_moment(distance) * scale_;
      store(&shares[i], cubic_share(distance));
      store(&moments[i], moment);
      store(&edge_moments[i], moment);
    }
    return;
  }
  for (std::size_t i = 0; i < d.size(); ++i) {
    shares[i] = share(d[i], nx[i], ny[i]);
    moments[i] = moment(d[i], nx[i], ny[i]);
    edge_moments[i] = edge_moment(d[i], nx[i], ny[i]);
  }
}

std::array<float, 2> Filter::place(float u, float v) const {
  if (kind_ == FilterKind::box) return {(u - 0.5f) * scale_, (v - 0.5f) * scale_};
  const auto [signed_distance, angle] = disc_place(u, v);
  const float p = std::min(signed_distance * signed_distance, 1.0f);  // uniform in [0, 1]
  const auto radius = [&, p = p]() -> float {
    switch (kind_) {
      case FilterKind::cubic:
        return 0.5f * root(1 - num::pow(1 - p, 2.0f / 3));
      case FilterKind::disc:
        return root(p);
      case FilterKind::paraboloid:
        return root(1 - root(1 - p));
      case FilterKind::cone:
        return 0.5f - num::sin(num::asin(1 - 2 * p) / 3);
      default: {
        const float all = 1 - num::exp(-0.5f * gauss_reach * gauss_reach / (deviation * deviation));
        return deviation * root(-2 * num::log(1 - p * all));
      }
    }
  };
  const float r = (signed_distance < 0 ? -radius() : radius()) * scale_;
  return {r * num::cos(angle), r * num::sin(angle)};
}

}  // namespace pse::antialias
