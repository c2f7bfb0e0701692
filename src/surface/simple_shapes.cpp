// Sphere, box and plane.
#include <numbers>

#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr double pi = std::numbers::pi;

class Sphere : public SingleShape {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  Box bounds() const override {
    return {{-radius_, -radius_, -radius_}, {radius_, radius_, radius_}};
  }

 private:
  void meet(const Ray& ray, ShapeHit& hit) const override {
    // Measured from the ray's point nearest to the centre, so that far rays lose nothing.
    const double dd = dot(ray.direction, ray.direction);
    const double nearest = -dot(ray.origin, ray.direction) / dd;
    const Vec3 closest = ray.origin + nearest * ray.direction;
    const double rest = radius_ * radius_ - dot(closest, closest);
    if (!(rest >= 0)) return;
    const double half = std::sqrt(rest / dd);
    double t = nearest - half;
    if (!(t > ray.begin)) t = nearest + half;
    if (!(t > ray.begin && t < ray.end)) return;
    hit.t = t;
    hit.normal = hit.flat = (1 / radius_) * (closest + (t - nearest) * ray.direction);
    hit.u = std::atan2(-hit.normal.z, hit.normal.x) / (2 * pi);
    if (hit.u < 0) hit.u += 1;
    hit.v = 0.5 + std::asin(std::clamp(hit.normal.y, -1.0, 1.0)) / pi;
  }

  double radius_;
};

class Cuboid : public SingleShape {
 public:
  explicit Cuboid(const Vec3& size) : box_{-0.5 * size, 0.5 * size} {}
  Box bounds() const override { return box_; }

 private:
  void meet(const Ray& ray, ShapeHit& hit) const override {
    // The last entry into the three slabs, and the first exit.
    double in = -Box::inf, out = Box::inf;
    int in_axis = 0, out_axis = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double o = ray.origin[axis], d = ray.direction[axis];
      if (d == 0) {
        if (o < box_.lower[axis] || o > box_.upper[axis]) return;
        continue;
      }
      const double a = (box_.lower[axis] - o) / d, b = (box_.upper[axis] - o) / d;
      if (std::min(a, b) > in) in = std::min(a, b), in_axis = axis;
      if (std::max(a, b) < out) out = std::max(a, b), out_axis = axis;
    }
    if (!(in <= out)) return;
    const bool entering = in > ray.begin;
    const double t = entering ? in : out;
    if (!(t > ray.begin && t < ray.end)) return;
    const int axis = entering ? in_axis : out_axis;
    const double side = (ray.direction[axis] > 0) == entering ? -1 : 1;
    hit.t = t;
    hit.normal = hit.flat = {axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
    const Vec3 p = ray.origin + t * ray.direction, size = box_.upper - box_.lower;
    const Vec3 q = {(p.x - box_.lower.x) / size.x, (p.y - box_.lower.y) / size.y,
                    (p.z - box_.lower.z) / size.z};
    // Each face has the whole square, upright where it stands.
    if (axis == 0)
      hit.u = side > 0 ? 1 - q.z : q.z, hit.v = q.y;
    else if (axis == 1)
      hit.u = q.x, hit.v = side > 0 ? 1 - q.z : q.z;
    else
      hit.u = side > 0 ? q.x : 1 - q.x, hit.v = q.y;
    hit.u = std::clamp(hit.u, 0.0, 1.0), hit.v = std::clamp(hit.v, 0.0, 1.0);
  }

  Box box_;
};

class Plane : public SingleShape {
 public:
  explicit Plane(double size) : half_(0.5 * size) {}
  Box bounds() const override { return {{-half_, 0, -half_}, {half_, 0, half_}}; }

 private:
  void meet(const Ray& ray, ShapeHit& hit) const override {
    const double t = -ray.origin.y / ray.direction.y;
    if (!(t > ray.begin && t < ray.end)) return;  // also where the ray is parallel
    const double x = ray.origin.x + t * ray.direction.x, z = ray.origin.z + t * ray.direction.z;
    if (!(std::abs(x) <= half_ && std::abs(z) <= half_)) return;
    hit.t = t;
    hit.normal = hit.flat = {0, 1, 0};
    hit.u = x, hit.v = -z;
  }

  double half_;
};

}  // namespace

std::shared_ptr<const Shape> make_sphere(double radius) {
  return std::make_shared<Sphere>(radius);
}
std::shared_ptr<const Shape> make_box(const Vec3& size) { return std::make_shared<Cuboid>(size); }
std::shared_ptr<const Shape> make_plane(double size) { return std::make_shared<Plane>(size); }

}  // namespace pse::surface
