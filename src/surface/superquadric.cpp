// The superquadric, by its gauge: the function that is 1 on the surface and grows in proportion
// along rays from the centre. For exponents up to 2 it is convex, and then Newton's method from
// outside never oversteps the first root.
#include <array>
#include <numbers>

#include "surface/shapes.h"

namespace pse::surface {
namespace {


class Superquadric : public SingleShape {
 public:
  Superquadric(const Vec3& half_axes, double north, double east)
      : axes_(half_axes), north_(north), east_(east) {}
  Box bounds() const override { return {-axes_, axes_}; }

 private:
  // The gauge less 1 at p, and its gradient.
  double gauge(const Vec3& p, Vec3& gradient) const {
    const double x = std::abs(p.x) / axes_.x, y = std::abs(p.y) / axes_.y,
                 z = std::abs(p.z) / axes_.z;
    const double ring = std::pow(x, 2 / east_) + std::pow(z, 2 / east_);
    const double f = std::pow(ring, east_ / north_) + std::pow(y, 2 / north_);
    gradient = {};
    if (!(f > 0)) return -1;
    const double outer = std::pow(f, north_ / 2 - 1);
    if (ring > 0) {
      const double inner = outer * std::pow(ring, east_ / north_ - 1);
      if (x > 0) gradient.x = std::copysign(inner * std::pow(x, 2 / east_ - 1) / axes_.x, p.x);
      if (z > 0) gradient.z = std::copysign(inner * std::pow(z, 2 / east_ - 1) / axes_.z, p.z);
    }
    if (y > 0) gradient.y = std::copysign(outer * std::pow(y, 2 / north_ - 1) / axes_.y, p.y);
    return outer * f - 1;
  }

  double along(const Ray& ray, double t, double& slope) const {
    Vec3 gradient;
    const double value = gauge(ray.origin + t * ray.direction, gradient);
    slope = dot(gradient, ray.direction);
    return value;
  }

  // Newton's method from t towards `end` on a convex function that is positive at t.
  double descend(const Ray& ray, double t, double end) const {
    const double way = end > t ? 1 : -1;
    for (int step = 0; step < 100; ++step) {
      double slope;
      const double value = along(ray, t, slope);
      if (value <= 1e-14) return t;
      if (!(slope * way < 0)) return Box::inf;  // the least value is passed
      const double next = t - value / slope;
      if ((end - next) * way < 0) return Box::inf;
      if (next == t) return t;
      t = next;
    }
    return t;
  }

  // Small steps, then halving: for shapes with waists. The function is least where the ray crosses
  // a plane between octants, so steps begin and end there.
  double march(const Ray& ray, double begin, double end) const {
    std::array<double, 5> stops = {begin, begin, begin, begin, end};
    for (int axis = 0; axis < 3; ++axis) {
      const double t = -ray.origin[axis] / ray.direction[axis];
      if (t > begin && t < end) stops[static_cast<std::size_t>(axis) + 1] = t;
    }
    std::sort(stops.begin(), stops.end());
    double slope;
    const bool outside = along(ray, begin, slope) > 0;
    for (std::size_t k = 0; k + 1 < stops.size(); ++k)
      for (int i = 1; i <= steps && stops[k + 1] > stops[k]; ++i) {
        double a = stops[k] + (stops[k + 1] - stops[k]) * (i - 1) / steps,
               b = i == steps ? stops[k + 1] : stops[k] + (stops[k + 1] - stops[k]) * i / steps;
        if ((along(ray, b, slope) > 0) == outside) continue;
        for (int halving = 0; halving < 60; ++halving) {
          const double middle = 0.5 * (a + b);
          ((along(ray, middle, slope) > 0) == outside ? a : b) = middle;
        }
        return 0.5 * (a + b);
      }
    return Box::inf;
  }
  static constexpr int steps = 128;

  void meet(const Ray& ray, Meeting& meeting) const override {
    const Span1 span = clip(ray, bounds());
    if (!(span.begin <= span.end) || !std::isfinite(span.end)) return;
    double t;
    if (east_ > 2 || north_ > 2) {
      t = march(ray, span.begin, span.end);
    } else {
      double slope;
      // A ray that comes into the box is outside even where a flat side touches the box.
      const bool outside = span.begin > ray.begin || along(ray, span.begin, slope) > 1e-9;
      t = outside ? descend(ray, span.begin, span.end) : descend(ray, span.end, span.begin);
    }
    if (!(t > ray.begin && t < ray.end)) return;
    const Vec3 p = ray.origin + t * ray.direction;
    Vec3 normal;
    gauge(p, normal);
    if (!(dot(normal, normal) > 0)) return;
    meeting.t = t;
  }

  ShapePoint look(const Vec3& p, const Meeting&, bool with_uv) const override {
    ShapePoint point;
    gauge(p, point.normal);
    point.flat = point.normal;
    if (!with_uv) return point;
    point.u = std::atan2(-p.z / axes_.z, p.x / axes_.x) / (2 * std::numbers::pi);
    if (point.u < 0) point.u += 1;
    const double out = std::hypot(p.x / axes_.x, p.z / axes_.z);
    point.v = 0.5 + std::atan2(p.y / axes_.y, out) / std::numbers::pi;
    return point;
  }

  Vec3 axes_;
  double north_, east_;
};

}  // namespace

std::shared_ptr<const Shape> make_superquadric(const Vec3& half_axes, double north, double east) {
  return std::make_shared<Superquadric>(half_axes, north, east);
}

}  // namespace pse::surface
