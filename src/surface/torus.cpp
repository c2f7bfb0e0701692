// The torus: a quartic in the ray's parameter.
#include <numbers>

#include "surface/roots.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr double pi = std::numbers::pi;

class Torus : public SingleShape {
 public:
  Torus(double major, double minor) : major_(major), minor_(minor) {}
  Box bounds() const override {
    const double r = major_ + minor_;
    return {{-r, -minor_, -r}, {r, minor_, r}};
  }
  double thickness() const override { return 2 * minor_; }

 private:
  void meet(const Ray& ray, Meeting& meeting) const override {
    // The part of the ray inside the box, as x in [0, 1], so that the numbers stay near 1.
    const Span1 span = clip(ray, bounds());
    if (!(span.begin <= span.end)) return;
    const double stretch = span.end - span.begin;
    const Vec3 o = ray.origin + span.begin * ray.direction, d = stretch * ray.direction;
    // (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2)
    const double a = dot(d, d), b = 2 * dot(o, d);
    const double c = dot(o, o) + major_ * major_ - minor_ * minor_, k = 4 * major_ * major_;
    const double quartic[5] = {c * c - k * (o.x * o.x + o.z * o.z),
                               2 * b * c - 2 * k * (o.x * d.x + o.z * d.z),
                               b * b + 2 * a * c - k * (d.x * d.x + d.z * d.z), 2 * a * b, a * a};
    const Roots roots = roots_in_unit(quartic, 4, false);
    for (std::size_t i = 0; i < roots.count; ++i) {
      const double t = span.begin + stretch * roots.at[i];
      if (!(t > ray.begin && t < ray.end)) continue;
      meeting.t = t;
      return;
    }
  }

  ShapePoint look(const Vec3& p, const Meeting&, bool with_uv) const override {
    const double ring = std::sqrt(p.x * p.x + p.z * p.z);
    const Vec3 middle =
        ring > 0 ? (major_ / ring) * Vec3{p.x, 0, p.z} : Vec3{major_, 0, 0};
    if (!with_uv) return {p - middle, p - middle, 0, 0};
    double u = std::atan2(-p.z, p.x) / (2 * pi), v = std::atan2(p.y, ring - major_) / (2 * pi);
    if (u < 0) u += 1;
    if (v < 0) v += 1;
    return {p - middle, p - middle, u, v};
  }

  double major_, minor_;
};

}  // namespace

std::shared_ptr<const Shape> make_torus(double major, double minor) {
  return std::make_shared<Torus>(major, minor);
}

}  // namespace pse::surface
