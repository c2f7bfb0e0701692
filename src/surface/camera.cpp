// Rays from the eye through the picture.
#include "surface/camera.h"

#include <numbers>

namespace pse::surface {

Camera framing(const Box& box, double aspect, double fov) {
  Camera camera;
  camera.fov = fov;
  const Box seen = box.bounded() ? box : Box{{-1, -1, -1}, {1, 1, 1}};
  camera.target = seen.centre();
  const double half = camera.fov * std::numbers::pi / 360;
  const double narrow = std::atan(std::tan(half) * std::min(1.0, aspect));
  const double radius = std::max(seen.radius(), 1e-9);
  camera.eye = camera.target + (0.92 * radius / std::sin(narrow)) * normalized(Vec3{0.35, 0.4, 1});
  return camera;
}

Lens::Lens(const Camera& camera, int width, int height)
    : eye_(camera.eye),
      forward_(normalized(camera.target - camera.eye)),
      right_(normalized(cross(forward_, camera.up))),
      up_(cross(right_, forward_)),
      width_(width),
      height_(height),
      scale_(camera.height > 0 ? camera.height / 2
                               : std::tan(camera.fov * std::numbers::pi / 360)),
      pixel_(2 * scale_ / height),
      parallel_(camera.height > 0) {}

Ray Lens::ray(double x, double y) const {
  const double across = scale_ * (2 * x - width_) / height_,
               upward = scale_ * (height_ - 2 * y) / height_;
  const Vec3 offset = across * right_ + upward * up_;
  if (parallel_) return {eye_ + offset, forward_};
  return {eye_, normalized(forward_ + offset)};
}

}  // namespace pse::surface
