// Rays for tests of shapes: many of them, the same at every run, most of them meeting something.
#pragma once

#include <random>

#include "surface/shape.h"

namespace pse::surface {

// From points on a sphere of this radius towards points inside one of radius 1.2.
inline std::vector<Ray> rays_inward(std::size_t count, double radius, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = radius * normalized({normal(random), normal(random), normal(random)});
    const Vec3 target = (1.2 * std::cbrt(uniform(random))) *
                        normalized({normal(random), normal(random), normal(random)});
    ray.direction = normalized(target - ray.origin);
  }
  return rays;
}

// What a ray meets first, and what it sees there.
struct ShapeHit : Meeting, ShapePoint {};
inline ShapeHit first_hit(const Shape& shape, const Ray& ray) {
  ShapeHit hit;
  shape.find({&ray, 1}, {static_cast<Meeting*>(&hit), 1});
  if (hit.found())
    shape.describe({&ray, 1}, {static_cast<const Meeting*>(&hit), 1}, true,
                   {static_cast<ShapePoint*>(&hit), 1});
  return hit;
}

}  // namespace pse::surface
