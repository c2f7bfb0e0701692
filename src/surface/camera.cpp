// Rays from the eye through the picture.
#include "surface/camera.h"

#include <array>
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

// Roots and quotients of several rays at once.
void Lens::rays(std::span<const double> x, std::span<const double> y,
                std::span<const std::uint32_t> which, std::span<Ray> rays) const {
  constexpr std::size_t most = 64;
  for (std::size_t first = 0; first < which.size(); first += most) {
    const std::size_t count = std::min(most, which.size() - first);
    std::array<Vec3, most> away;
    std::array<double, most> scales;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t i = which[first + k];
      const double across = step_ * (2 * x[i] - width_), upward = step_ * (height_ - 2 * y[i]);
      away[k] = across * right_ + upward * up_;
      if (!parallel_) away[k] = forward_ + away[k];
      scales[k] = dot(away[k], away[k]);
    }
    if (parallel_) {
      for (std::size_t k = 0; k < count; ++k) rays[first + k] = {eye_ + away[k], forward_};
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) scales[k] = 1 / std::sqrt(scales[k]);
    for (std::size_t k = 0; k < count; ++k) rays[first + k] = {eye_, scales[k] * away[k]};
  }
}

}  // namespace pse::surface
