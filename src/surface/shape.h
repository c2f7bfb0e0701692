// A shape is something that a ray can hit, in coordinates of its own. Every primitive of the 1985
// paper's pictures and every mesh is one; scene.h places them in the world.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "surface/vec.h"

namespace pse::surface {

// Points origin + t direction with t in (begin, end). The direction need not have length 1.
struct Ray {
  Vec3 origin, direction;
  double begin = 0, end = std::numeric_limits<double>::infinity();
};

// Where a ray first meets a shape.
struct ShapeHit {
  double t = std::numeric_limits<double>::infinity();
  Vec3 normal;  // outward, of any length but 0
  Vec3 flat;    // the same of the flat triangle, where the shape is made of such; else `normal`
  double u = 0, v = 0;
  bool found() const { return t < std::numeric_limits<double>::infinity(); }
};

class Shape {
 public:
  virtual ~Shape() = default;
  // What the shape reaches; of infinite size for the endless plane.
  virtual Box bounds() const = 0;
  // hits[i] becomes ray i's first hit, or stays not found. A hit depends on its ray alone. Called
  // from several threads at once. Rays are finite with a direction that is not 0.
  virtual void intersect(std::span<const Ray> rays, std::span<ShapeHit> hits) const = 0;
};

// A shape that is met ray by ray.
class SingleShape : public Shape {
 public:
  void intersect(std::span<const Ray> rays, std::span<ShapeHit> hits) const final {
    for (std::size_t i = 0; i < rays.size(); ++i) meet(rays[i], hits[i]);
  }

 protected:
  virtual void meet(const Ray& ray, ShapeHit& hit) const = 0;
};

// Part of the ray inside a box, cut to the ray's own range; empty (begin > end) where it misses.
inline Span1 clip(const Ray& ray, const Box& box) {
  Span1 span{ray.begin, ray.end};
  for (int axis = 0; axis < 3; ++axis) {
    const double o = ray.origin[axis], d = ray.direction[axis];
    if (d == 0) {
      if (o < box.lower[axis] || o > box.upper[axis]) return {1, 0};
      continue;
    }
    const double a = (box.lower[axis] - o) / d, b = (box.upper[axis] - o) / d;
    span.begin = std::max(span.begin, std::min(a, b));
    span.end = std::min(span.end, std::max(a, b));
  }
  return span;
}

}  // namespace pse::surface
