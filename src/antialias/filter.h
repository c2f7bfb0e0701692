// The reconstruction kernel of a pixel: what share of it lies on one side of an edge, and where to
// sample it. 2002 chapter, "The High-Contrast Filter": the kernel is circularly symmetric, so the
// share depends on the distance d alone; its cubic S(d) is that of the kernel
// (12 / pi) sqrt(1/4 - r^2) of radius 1/2, whose projection on a line is 6 (1/4 - t^2).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace pse::antialias {

enum class FilterKind : std::uint8_t {
  cubic,       // the chapter's, radius 1/2
  box,         // the pixel's square
  disc,        // a disc of radius 1, the same everywhere
  cone,        // 1 - r, radius 1
  paraboloid,  // 1 - r^2, radius 1
  gauss,       // standard deviation 1/2, cut at 2
};
std::optional<FilterKind> filter_named(std::string_view name);

class Filter {
 public:
  // `scale` widens the kernel.
  explicit Filter(FilterKind kind = FilterKind::cubic, float scale = 1)
      : kind_(kind), scale_(scale) {}

  // No weight beyond this distance from the centre along the direction (nx, ny), in pixels.
  float reach(float nx, float ny) const;
  float reach() const;  // in any direction

  bool operator==(const Filter&) const = default;

  bool is_round() const { return kind_ != FilterKind::box; }

  // Of a place under the kernel, along any direction; in pixels squared.
  float variance() const;

  // The mean fourth power of a place's distance from the centre along either axis, and the mean
  // product of the squares along both; in pixels to the fourth.
  struct FourthMoments {
    float along, across;
  };
  FourthMoments fourth_moments() const;

  // The share on the side of a straight edge that the normal (nx, ny) points to, where the centre
  // is d pixels on that side; 0 to 1, exact. Of the chapter's kernel 0 for d < -1/2, 1 for d > 1/2,
  // else 3 (d + 1/2)^2 - 2 (d + 1/2)^3.
  float share(float d, float nx, float ny) const;

  // The first moment of that side along the normal: its centroid is moment / share away from the
  // centre.
  float moment(float d, float nx, float ny) const;

  // The second moment of the edge itself under the kernel, along the edge from where the centre is
  // nearest: an edge of curvature k gains or loses k / 2 times this. For kernels that are symmetric
  // about their centre it is the same number as moment().
  float edge_moment(float d, float nx, float ny) const;

  // All three for many edges at once. All spans are as long as d, a multiple of four.
  struct Measures {
    std::span<float> share, moment, edge_moment;
  };
  void measure(std::span<const float> d, std::span<const float> nx, std::span<const float> ny,
               const Measures& measures) const;

  // What lies within a circle: its share of the kernel, and the share's first moment.
  struct Within {
    float share, x, y;
  };
  // The circle's middle is (x, y) pixels from the kernel's; exact to 1e-4 (filter_circle.cpp).
  Within within(float x, float y, float radius) const;

  // An offset from the centre for a point of the unit square, such that all have equal weight.
  std::array<float, 2> place(float u, float v) const;

 private:
  Within box_within(float x, float y, float radius) const;
  float mass_per_square(float square) const;

  FilterKind kind_;
  float scale_;
};

}  // namespace pse::antialias
