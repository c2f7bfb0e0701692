// Where the eye is and what it sees: places in the picture to rays.
#pragma once

#include "surface/shape.h"

namespace pse::surface {

struct Camera {
  Vec3 eye{0, 0, 5}, target, up{0, 1, 0};
  // False where the view is along `up`, so that nothing says what is upward. Along Y something
  // does: X stays to the right.
  bool has_upright() const;
  double fov = 30;    // degrees from the picture's bottom to its top
  double height = 0;  // orthographic where not 0: metres from bottom to top
};

// A camera that shows all of a box from the front, a little from above and from the right.
Camera framing(const Box& box, double aspect, double fov);

// A camera for pictures of one size. `eye` and `target` differ, it has an upright.
class Lens {
 public:
  Lens(const Camera& camera, int width, int height);

  // Through the place (x, y) in pixels from the top left corner; the direction has length 1.
  Ray ray(double x, double y) const {
    const double across = step_ * (2 * x - width_), upward = step_ * (height_ - 2 * y);
    const Vec3 offset = across * right_ + upward * up_;
    if (parallel_) return {eye_ + offset, forward_};
    return {eye_, normalized(forward_ + offset)};
  }
  // rays[k] becomes ray(x[which[k]], y[which[k]]), the same bits.
  void rays(std::span<const double> x, std::span<const double> y,
            std::span<const std::uint32_t> which, std::span<Ray> rays) const;
  // How far in front of the eye's plane a point of that ray at distance t lies.
  double depth(const Ray& ray, double t) const {
    return t * dot(ray.direction, forward_) + dot(ray.origin - eye_, forward_);
  }
  // A pixel's width at distance t along the ray.
  double width(const Ray& ray, double t) const {
    return parallel_ ? pixel_ : pixel_ * t * dot(ray.direction, forward_);
  }
  double pixel_angle() const { return pixel_; }
  // Grows with depth by 1 for each width of a pixel there.
  float depth_in_pixels(float depth) const {
    return static_cast<float>((parallel_ ? depth : std::log(std::max(depth, 1e-30f))) / pixel_);
  }
  // Where in the picture a point is seen, in pixels, and how wide a pixel is at its depth; not
  // above 0 for what is not before the eye, and of no use then.
  struct Seen {
    double x, y, pixel;
  };
  Seen project(const Vec3& point) const {
    const Vec3 away = point - eye_;
    const double scale = parallel_ ? step_ : step_ * dot(away, forward_);
    return {0.5 * (width_ + dot(away, right_) / scale), 0.5 * (height_ - dot(away, up_) / scale),
            2 * scale};
  }
  double picture_width() const { return width_; }  // in pixels
  double picture_height() const { return height_; }
  const Vec3& eye() const { return eye_; }
  const Vec3& right() const { return right_; }
  const Vec3& up() const { return up_; }

 private:
  Vec3 eye_, forward_, right_, up_;
  double width_, height_;
  double scale_;  // half the picture's height at distance 1, or in metres
  double step_;   // half a pixel's height there
  double pixel_;
  bool parallel_;
};

}  // namespace pse::surface
