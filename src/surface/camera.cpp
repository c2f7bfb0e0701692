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

namespace {

bool looks_along_up(const Camera& camera) {
  const Vec3 way = camera.target - camera.eye, side = cross(way, camera.up);
  return !(dot(side, side) > 1e-12 * dot(way, way) * dot(camera.up, camera.up));
}

// What is upward in the picture; where the view is along Y, Z, so that X stays to the right.
Vec3 upward(const Camera& camera) {
  if (!looks_along_up(camera)) return camera.up;
  return {0, 0, camera.target.y > camera.eye.y ? 1.0 : -1.0};
}

}  // namespace

bool Camera::has_upright() const { return up == Vec3{0, 1, 0} || !looks_along_up(*this); }

Lens::Lens(const Camera& camera, int width, int height)
    : eye_(camera.eye),
      forward_(normalized(camera.target - camera.eye)),
      right_(normalized(cross(forward_, upward(camera)))),
      up_(cross(right_, forward_)),
      width_(width),
      height_(height),
      scale_(camera.height > 0 ? camera.height / 2
                               : std::tan(camera.fov * std::numbers::pi / 360)),
      step_(scale_ / height),
      pixel_(2 * scale_ / height),
      parallel_(camera.height > 0) {}

}  // namespace pse::surface
