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
  void meet(const Ray& ray, Meeting& meeting) const override {
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
    meeting.t = t;
  }
  ShapePoint look(const Vec3& place, const Meeting&, bool with_uv) const override {
    const Vec3 normal = (1 / radius_) * place;
    if (!with_uv) return {normal, normal, 0, 0};
    double u = std::atan2(-normal.z, normal.x) / (2 * pi);
    if (u < 0) u += 1;
    return {normal, normal, u, 0.5 + std::asin(std::clamp(normal.y, -1.0, 1.0)) / pi};
  }

  double radius_;
};

class Cuboid : public SingleShape {
 public:
  explicit Cuboid(const Vec3& size) : box_{-0.5 * size, 0.5 * size} {}
  Box bounds() const override { return box_; }

 private:
  // Faces are counted by axis, the lower one first.
  void meet(const Ray& ray, Meeting& meeting) const override {
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
    const bool lower = (ray.direction[axis] > 0) == entering;
    meeting.t = t, meeting.part = static_cast<std::uint32_t>(2 * axis + (lower ? 0 : 1));
  }
  ShapePoint look(const Vec3& p, const Meeting& meeting, bool) const override {
    const std::uint32_t axis = meeting.part / 2;
    const double side = meeting.part % 2 == 0 ? -1 : 1;
    ShapePoint point;
    point.normal = point.flat = {axis == 0 ? side : 0, axis == 1 ? side : 0, axis == 2 ? side : 0};
    const Vec3 size = box_.upper - box_.lower;
    const Vec3 q = {(p.x - box_.lower.x) / size.x, (p.y - box_.lower.y) / size.y,
                    (p.z - box_.lower.z) / size.z};
    // Each face has the whole square, upright where it stands.
    if (axis == 0)
      point.u = side > 0 ? 1 - q.z : q.z, point.v = q.y;
    else if (axis == 1)
      point.u = q.x, point.v = side > 0 ? 1 - q.z : q.z;
    else
      point.u = side > 0 ? q.x : 1 - q.x, point.v = q.y;
    point.u = std::clamp(point.u, 0.0, 1.0), point.v = std::clamp(point.v, 0.0, 1.0);
    return point;
  }

  Box box_;
};

class Plane : public SingleShape {
 public:
  explicit Plane(double size) : half_(0.5 * size) {}
  Box bounds() const override { return {{-half_, 0, -half_}, {half_, 0, half_}}; }

 private:
  void meet(const Ray& ray, Meeting& meeting) const override {
    const double t = -ray.origin.y / ray.direction.y;
    if (!(t > ray.begin && t < ray.end)) return;  // also where the ray is parallel
    const double x = ray.origin.x + t * ray.direction.x, z = ray.origin.z + t * ray.direction.z;
    if (!(std::abs(x) <= half_ && std::abs(z) <= half_)) return;
    meeting.t = t;
  }
  ShapePoint look(const Vec3& place, const Meeting&, bool) const override {
    return {{0, 1, 0}, {0, 1, 0}, place.x, -place.z};
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
