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

inline ShapeHit first_hit(const Shape& shape, const Ray& ray) {
  ShapeHit hit;
  shape.intersect(std::span(&ray, 1), std::span(&hit, 1));
  return hit;
}

}  // namespace pse::surface
