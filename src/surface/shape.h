// A shape is something that a ray can hit, in coordinates of its own. Every primitive of the 1985
// paper's pictures and every mesh is one; scene.h places them in the world.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "surface/vec.h"

namespace pse::surface {

// Points origin + t direction with t in (begin, end). The direction need not have length 1.
struct Ray {
  Vec3 origin, direction;
  double begin = 0, end = std::numeric_limits<double>::infinity();
};

// Where a ray first meets a shape: what tells the first of several meetings, and lets the shape say
// later what its surface is like there.
struct Meeting {
  double t = std::numeric_limits<double>::infinity();
  // The shape's own: weights of a triangle's corners and its number, or a profile's parameter and
  // piece, or a face.
  double a = 0, b = 0;
  std::uint32_t part = 0;
  bool found() const { return t < std::numeric_limits<double>::infinity(); }
};

// What a shape's surface is like at a meeting.
struct ShapePoint {
  Vec3 normal;  // outward, of any length but 0
  Vec3 flat;    // the same of the flat triangle, where the shape is made of such; else `normal`
  double u = 0, v = 0;
};

// Points, two or more, that stand for the smallest convex body which holds them.
using Hull = std::vector<Vec3>;

class Shape {
 public:
  virtual ~Shape() = default;
  // What the shape reaches; of infinite size for the endless plane.
  virtual Box bounds() const = 0;
  // Bodies that together hold all of the shape; none where it has no end.
  virtual std::vector<Hull> hulls() const {
    const Box box = bounds();
    return box.bounded() ? std::vector<Hull>{box.corners()} : std::vector<Hull>{};
  }
  // meetings[i], not found, becomes ray i's first, or stays. It depends on its ray alone, however
  // many others there are. Called from several threads at once. Rays are finite with a direction
  // that is not 0.
  virtual void find(std::span<const Ray> rays, std::span<Meeting> meetings) const = 0;
  // What the surface is like at meetings that were found with these rays; u and v only where
  // wanted, since they may cost as much as all the rest.
  virtual void describe(std::span<const Ray> rays, std::span<const Meeting> meetings, bool with_uv,
                        std::span<ShapePoint> points) const = 0;
  // How wide it is at its thinnest, in its own frame: what is much finer is passed by.
  virtual double thickness() const {
    const Vec3 size = bounds().upper - bounds().lower;
    return std::max({size.x, size.y, size.z});
  }
  // Why nobody will see the shape, as a sentence; empty where it may be seen. May take as long as
  // many rays.
  virtual std::string why_unseen() const { return ""; }
};

// A shape that is met ray by ray.
class SingleShape : public Shape {
 public:
  void find(std::span<const Ray> rays, std::span<Meeting> meetings) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) meet(rays[i], meetings[i]);
  }
  void describe(std::span<const Ray> rays, std::span<const Meeting> meetings, bool with_uv,
                std::span<ShapePoint> points) const override {
    for (std::size_t i = 0; i < rays.size(); ++i)
      points[i] = look(rays[i].origin + meetings[i].t * rays[i].direction, meetings[i], with_uv);
  }

 protected:
  virtual void meet(const Ray& ray, Meeting& meeting) const = 0;
  virtual ShapePoint look(const Vec3& place, const Meeting& meeting, bool with_uv) const = 0;
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
