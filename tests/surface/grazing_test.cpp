// Rays that only just meet a shape, or only just do not: where they touch it is known from plane
// sections, which are circles, ellipses and straight lines.
#include <gtest/gtest.h>

#include "rays.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr double away = 4;

// Along X at this height and depth, meeting x = 0 after `away`.
Ray along_x(double y, double z) { return {{-away, y, z}, {1, 0, 0}}; }

// By how much, of the distance at which it would touch, a ray comes in.
constexpr double shares[] = {0.5, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12};

// The section at the height h is two circles of radius R +- sqrt(r^2 - h^2).
TEST(Grazing, TorusFromTheSide) {
  const auto torus = make_torus(0.75, 0.25);
  for (const double h : {0.0, 0.15, -0.2}) {
    const double outer = 0.75 + std::sqrt(0.25 * 0.25 - h * h);
    for (const double share : shares) {
      const double z = outer * (1 - share), half = std::sqrt((outer - z) * (outer + z));
      const ShapeHit hit = first_hit(*torus, along_x(h, z));
      ASSERT_TRUE(hit.found()) << h << " " << share;
      // The square of half the chord is what rounding spoils by a fixed amount.
      EXPECT_NEAR((away - hit.t) * (away - hit.t), half * half, 1e-13) << h << " " << share;
      EXPECT_FALSE(first_hit(*torus, along_x(h, outer * (1 + share))).found()) << h << " " << share;
    }
  }
}

// What lies exactly on the side of its box is met: the tube's outermost points.
TEST(Grazing, TorusAtItsOutermost) {
  const auto torus = make_torus(0.75, 0.25);
  for (const Vec3& way : {Vec3{0, 0, -1}, Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}})
    EXPECT_EQ(first_hit(*torus, {-4.0 * way, way}).t, 3);
  for (const double x : {0.75, -0.75}) {
    EXPECT_EQ(first_hit(*torus, {{x, 4, 0}, {0, -1, 0}}).t, 3.75);
    EXPECT_EQ(first_hit(*torus, {{0, -4, x}, {0, 1, 0}}).t, 3.75);
  }
}

// Over the tube's crest the section has shrunk to s = sqrt(r^2 - h^2), and the ray is seen from
// x^2 + R^2 = (R + s)^2 on.
TEST(Grazing, TorusOverItsCrest) {
  const auto torus = make_torus(0.75, 0.25);
  for (const double share : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    const double h = 0.25 * (1 - share), s = std::sqrt((0.25 - h) * (0.25 + h));
    const ShapeHit hit = first_hit(*torus, along_x(h, 0.75));
    ASSERT_TRUE(hit.found()) << share;
    EXPECT_NEAR(away - hit.t, std::sqrt(s * (1.5 + s)), 1e-14 / (s * std::sqrt(s))) << share;
    EXPECT_FALSE(first_hit(*torus, along_x(0.25 * (1 + share), 0.75)).found()) << share;
  }
}

// With both exponents 1 it is an ellipsoid: at y = 0.3 of 0.5 four fifths of its width are left.
TEST(Grazing, Ellipsoid) {
  const auto ellipsoid = make_superquadric({0.9, 0.5, 0.7}, 1, 1);
  for (const double share : shares) {
    const double z = 0.56 * (1 - share);
    const ShapeHit hit = first_hit(*ellipsoid, along_x(0.3, z));
    ASSERT_TRUE(hit.found()) << share;
    EXPECT_NEAR((away - hit.t) * (away - hit.t), 0.81 * 0.64 * share * (2 - share), 1e-13) << share;
    EXPECT_FALSE(first_hit(*ellipsoid, along_x(0.3, 0.56 * (1 + share))).found()) << share;
  }
}

// Whatever shapes the outline, with a round cross-section the middle is a circle.
TEST(Grazing, SuperquadricAroundItsMiddle) {
  for (const double north : {0.2, 0.5, 1.5, 2.0, 2.5}) {
    const auto shape = make_superquadric({0.8, 0.6, 0.8}, north, 1);
    for (const double share : shares) {
      const double z = 0.8 * (1 - share);
      const ShapeHit hit = first_hit(*shape, along_x(0, z));
      ASSERT_TRUE(hit.found()) << north << " " << share;
      EXPECT_NEAR((away - hit.t) * (away - hit.t), 0.64 * share * (2 - share), 1e-13)
          << north << " " << share;
      EXPECT_FALSE(first_hit(*shape, along_x(0, 0.8 * (1 + share))).found())
          << north << " " << share;
    }
  }
}

// The octahedron's corner is |x| + |z| = a, the star's x^(2/3) + z^(2/3) = a^(2/3).
TEST(Grazing, CornersOfOctahedronAndStar) {
  const auto octahedron = make_superquadric({0.9, 0.9, 0.9}, 2, 2);
  const auto star = make_superquadric({1, 1, 1}, 3, 3);
  for (const double share : {0.5, 1e-2, 1e-4, 1e-6, 1e-8}) {
    const ShapeHit flat = first_hit(*octahedron, along_x(0, 0.9 * (1 - share)));
    ASSERT_TRUE(flat.found()) << share;
    EXPECT_NEAR(away - flat.t, 0.9 * share, 1e-13) << share;
    EXPECT_FALSE(first_hit(*octahedron, along_x(0, 0.9 * (1 + share))).found()) << share;
    const ShapeHit sharp = first_hit(*star, along_x(0, 1 - share));
    ASSERT_TRUE(sharp.found()) << share;
    EXPECT_NEAR(away - sharp.t, std::pow(1 - std::pow(1 - share, 2.0 / 3), 1.5), 1e-12) << share;
    EXPECT_FALSE(first_hit(*star, along_x(0, 1 + share)).found()) << share;
  }
}

}  // namespace
}  // namespace pse::surface
