// Rays against shapes with a formula: a hit lies on the surface, nothing lies before it, and its
// normal is the formula's gradient.
#include <gtest/gtest.h>

#include <functional>

#include "rays.h"
#include "surface/shape_words.h"

namespace pse::surface {
namespace {

// Positive outside and negative inside, near the surface at least.
using Formula = std::function<double(const Vec3&)>;

struct Case {
  const char* name;
  std::shared_ptr<const Shape> shape;
  Formula f;
};

double gauge(const Vec3& p, double a, double b, double c, double n, double e) {
  const double ring = std::pow(std::abs(p.x / a), 2 / e) + std::pow(std::abs(p.z / c), 2 / e);
  return std::pow(std::pow(ring, e / n) + std::pow(std::abs(p.y / b), 2 / n), n / 2) - 1;
}

std::vector<Case> cases() {
  const auto box = [](const Vec3& p) {
    return std::max({std::abs(p.x) / 0.5, std::abs(p.y) / 0.4, std::abs(p.z) / 0.7}) - 1;
  };
  return {
      {"sphere", make_sphere(0.8), [](const Vec3& p) { return length(p) - 0.8; }},
      {"box", make_box({1, 0.8, 1.4}), box},
      {"torus", make_torus(0.7, 0.3),
       [](const Vec3& p) { return std::hypot(std::hypot(p.x, p.z) - 0.7, p.y) - 0.3; }},
      {"thin torus", make_torus(0.9, 0.01),
       [](const Vec3& p) { return std::hypot(std::hypot(p.x, p.z) - 0.9, p.y) - 0.01; }},
      {"spindle", make_torus(0.2, 0.5),
       [](const Vec3& p) {
         const double r = std::hypot(p.x, p.z);  // the quartic has both sheets
         return (std::hypot(r - 0.2, p.y) - 0.5) * (std::hypot(r + 0.2, p.y) - 0.5);
       }},
      {"ellipsoid", make_superquadric({0.9, 0.5, 0.7}, 1, 1),
       [](const Vec3& p) { return gauge(p, 0.9, 0.5, 0.7, 1, 1); }},
      {"rounded box", make_superquadric({0.9, 0.7, 0.8}, 0.2, 0.3),
       [](const Vec3& p) { return gauge(p, 0.9, 0.7, 0.8, 0.2, 0.3); }},
      {"octahedron", make_superquadric({0.9, 0.9, 0.9}, 2, 2),
       [](const Vec3& p) { return gauge(p, 0.9, 0.9, 0.9, 2, 2); }},
      {"star", make_superquadric({1, 1, 1}, 3, 3),
       [](const Vec3& p) { return gauge(p, 1, 1, 1, 3, 3); }},
      // A straight profile is a cone, whatever spline it goes through.
      {"cone", make_revolution({{0.9, -0.6}, {0.6, -0.2}, {0.3, 0.2}, {0.15, 0.4}}, true),
       [](const Vec3& p) {
         return std::max(std::hypot(p.x, p.z) - (0.9 - 0.75 * (p.y + 0.6)),
                         std::abs(p.y + 0.1) - 0.5);
       }},
  };
}

TEST(Shapes, AHitLiesOnTheSurface) {
  for (const Case& c : cases()) {
    std::size_t hits = 0;
    for (const Ray& ray : rays_inward(4000, 3)) {
      const ShapeHit hit = first_hit(*c.shape, ray);
      if (!hit.found()) continue;
      ++hits;
      const Vec3 p = ray.origin + hit.t * ray.direction;
      ASSERT_LT(std::abs(c.f(p)), 1e-9) << c.name << " at " << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(hits, 20u) << c.name;
  }
}

// Small steps along the ray find no surface before the hit, and none where none was found.
TEST(Shapes, NothingLiesBeforeAHit) {
  for (const Case& c : cases())
    for (const Ray& ray : rays_inward(1500, 3, 7)) {
      const ShapeHit hit = first_hit(*c.shape, ray);
      const double end = std::min(hit.t - 1e-3, 5.0);
      for (double t = 1; t < end; t += 0.002)
        ASSERT_GT(c.f(ray.origin + t * ray.direction), -1e-6)
            << c.name << " t " << t << " hit " << hit.t;
    }
}

// The same from the inside outward, so that far walls are found as well.
TEST(Shapes, FromInsideTheWallIsMet) {
  for (const Case& c : cases())
    for (Ray ray : rays_inward(1500, 3, 8)) {
      const ShapeHit entry = first_hit(*c.shape, ray);
      if (!entry.found()) continue;
      ray.begin = entry.t + 1e-6;
      const ShapeHit exit = first_hit(*c.shape, ray);
      const double middle = 0.5 * (entry.t + std::min(exit.t, 6.0));
      if (c.f(ray.origin + (entry.t + 1e-5) * ray.direction) > -1e-7) continue;  // grazing
      ASSERT_TRUE(exit.found()) << c.name;
      ASSERT_LT(c.f(ray.origin + middle * ray.direction), 1e-9) << c.name;
    }
}

TEST(Shapes, NormalsAreGradients) {
  for (const Case& c : cases()) {
    for (const Ray& ray : rays_inward(1000, 3, 3)) {
      const ShapeHit hit = first_hit(*c.shape, ray);
      if (!hit.found()) continue;
      const Vec3 p = ray.origin + hit.t * ray.direction;
      constexpr double h = 1e-6;
      const auto slope = [&](const Vec3& d) { return (c.f(p + h * d) - c.f(p - h * d)) / (2 * h); };
      Vec3 g = normalized({slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})});
      // Where faces meet there is no gradient.
      const Vec3 there = {slope({0.6, 0.8, 0}), slope({0, 0.6, 0.8}), slope({0.8, 0, 0.6})};
      const Vec3 linear = {0.6 * slope({1, 0, 0}) + 0.8 * slope({0, 1, 0}),
                           0.6 * slope({0, 1, 0}) + 0.8 * slope({0, 0, 1}),
                           0.8 * slope({1, 0, 0}) + 0.6 * slope({0, 0, 1})};
      if (length(there - linear) > 1e-3) continue;
      ASSERT_GT(dot(normalized(hit.normal), g), 1 - 1e-5)
          << c.name << " at " << p.x << " " << p.y << " " << p.z;
    }
  }
}

// Nearly level rays, level ones, and ones along the axis go through other code.
TEST(Shapes, RevolutionFromEveryDirection) {
  const auto shape = make_revolution({{0, -1}, {0.6, -0.8}, {0.8, 0}, {0.5, 0.5}, {0, 0.9}}, false);
  for (const double dy : {0.0, 1e-12, 1e-7, 0.9e-4, 1.1e-4, 1e-3, 0.1})
    for (int i = 0; i < 200; ++i) {
      const double y = -0.95 + 0.0093 * i, off = 0.3 * std::sin(i);
      const Ray ray{{-3, y - 3 * dy, off}, {1, dy, 0}};
      const Ray reference{{-3, y - 3 * 2e-3, off}, {1, 2e-3, 0}};
      const ShapeHit hit = first_hit(*shape, ray), near = first_hit(*shape, reference);
      if (!near.found() || dy > 1e-2) continue;
      if (std::abs(dot(normalized(near.normal), reference.direction)) < 0.2) continue;
      ASSERT_TRUE(hit.found()) << dy << " " << y;
      EXPECT_NEAR(hit.t, near.t, 0.03) << dy << " " << y;
    }
  const ShapeHit down = first_hit(*shape, {{0, 3, 0}, {0, -1, 0}});
  ASSERT_TRUE(down.found());
  EXPECT_NEAR(down.t, 2.1, 1e-9);
  EXPECT_GT(normalized(down.normal).y, 0.999);
}

TEST(Shapes, CoordinatesStayInTheUnitSquare) {
  for (const Case& c : cases())
    for (const Ray& ray : rays_inward(500, 3, 5)) {
      const ShapeHit hit = first_hit(*c.shape, ray);
      if (!hit.found()) continue;
      EXPECT_GE(hit.u, 0) << c.name;
      EXPECT_LE(hit.u, 1) << c.name;
      EXPECT_GE(hit.v, 0) << c.name;
      EXPECT_LE(hit.v, 1) << c.name;
    }
}

// An isosurface whose function is that of a torus is the torus.
TEST(Shapes, AnIsosurfaceIsTheShapeOfItsFunction) {
  const Field field = [](std::int64_t count, const float* x, const float* y, const float* z,
                         float* values) {
    for (std::int64_t i = 0; i < count; ++i)
      values[i] = 0.8f - std::hypot(std::hypot(x[i], z[i]) - 0.7f, y[i]);
  };
  const auto iso = make_isosurface(field, 0.5, {{-1.1, -1.1, -1.1}, {1.1, 1.1, 1.1}}, 0.02);
  const auto torus = make_torus(0.7, 0.3);
  const std::vector<Ray> rays = rays_inward(3000, 3);
  std::vector<Meeting> hits(rays.size());
  iso->find(rays, hits);
  int both = 0, one = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const ShapeHit exact = first_hit(*torus, rays[i]);
    if (exact.found() != hits[i].found()) {
      ++one;  // where the ray only touches it
      continue;
    }
    if (!exact.found()) continue;
    ++both;
    if (std::abs(exact.t - hits[i].t) > 0.01) {
      ++one;
      continue;
    }
    const double facing = -dot(normalized(exact.normal), rays[i].direction);
    EXPECT_NEAR(hits[i].t, exact.t, 1e-6 / std::max(facing, 0.05));
    const ShapeHit alone = first_hit(*iso, rays[i]);
    EXPECT_GT(dot(normalized(alone.normal), normalized(exact.normal)), 0.9999);
    EXPECT_EQ(alone.t, hits[i].t);  // a hit depends on its ray alone
  }
  EXPECT_GT(both, 1000);
  EXPECT_LT(one, both / 50);
}

// A ball of radius 1.6, in boxes that lie within it, at its edge and around it.
TEST(Shapes, AnIsosurfaceAroundAllOfItsBoxSaysThatItIsUnseen) {
  const Field ball = [](std::int64_t count, const float* x, const float* y, const float* z,
                        float* values) {
    for (std::int64_t i = 0; i < count; ++i) values[i] = 1.6f - std::hypot(x[i], y[i], z[i]);
  };
  const auto why = [&](const Field& f, double level, double half) {
    const Vec3 corner{half, half, half};
    return make_isosurface(f, level, {-corner, corner}, 0.02)->why_unseen();
  };
  EXPECT_NE(why(ball, 0, 0.9).find("above `level` 0 everywhere"), std::string::npos);
  EXPECT_EQ(why(ball, 0, 0.95), "");  // its corners are 1.645 from the centre
  EXPECT_EQ(why(ball, 0.7, 0.9), "");
  EXPECT_EQ(why(ball, 0, 2), "");
  // A bubble within it is seen.
  const Field hollow = [](std::int64_t count, const float* x, const float* y, const float* z,
                          float* values) {
    for (std::int64_t i = 0; i < count; ++i)
      values[i] = std::hypot(x[i] - 0.2f, y[i], z[i]) - 0.3f;
  };
  EXPECT_EQ(why(hollow, 0, 0.9), "");
  // Above what it reaches, and a bead between the places of a coarse lattice.
  EXPECT_NE(why(ball, 1.7, 2).find("nowhere above `level` 1.7"), std::string::npos);
  const Field bead = [](std::int64_t count, const float* x, const float* y, const float* z,
                        float* values) {
    for (std::int64_t i = 0; i < count; ++i)
      values[i] = 0.014f - std::hypot(x[i] - 0.015625f, y[i] - 0.015625f, z[i] - 0.015625f);
  };
  EXPECT_EQ(why(bead, 0, 1), "");
  EXPECT_EQ(make_sphere(1)->why_unseen(), "");
}

TEST(Shapes, SettingsInAnotherSpellingAreWrittenAsTheyShouldBe) {
  EXPECT_EQ(quoted_settings("superquadric:north=2"), "\"superquadric north=2\"");
  EXPECT_EQ(quoted_settings("superquadric(north=2,east=1)"), "\"superquadric north=2 east=1\"");
  EXPECT_EQ(quoted_settings("torus major=1:minor=0.2"), "\"torus major=1 minor=0.2\"");
  EXPECT_EQ(quoted_settings("sphere(2)"), "\"sphere radius=1\"");
  EXPECT_EQ(quoted_settings("blob.pse:level=2"), "\"blob.pse level=2\"");
  EXPECT_EQ(quoted_settings("sphere"), "");
  EXPECT_EQ(quoted_settings("ball:radius=2"), "");
  EXPECT_TRUE(has_setting("superquadric", "north"));
  EXPECT_TRUE(has_setting("bunny.obj", "fit"));
  EXPECT_FALSE(has_setting("sphere", "north"));
}

TEST(Shapes, AStepThatTakesForEverIsRefused) {
  const auto made = [](const std::string& words) {
    const auto shape = make_field_shape(
        *parse_shape(words), [](std::int64_t, const float*, const float*, const float*, float*) {});
    return shape ? "" : shape.error().message;
  };
  EXPECT_EQ(made("blob.pse step=0.001"), "");
  EXPECT_NE(made("blob.pse step=1e-9").find("for ever"), std::string::npos);
  EXPECT_NE(made("blob.pse step=0.001 bounds=1e6").find("for ever"), std::string::npos);
}

// Settings beyond their range are refused and say it; at its ends they are taken.
TEST(Shapes, SettingsHaveRanges) {
  const auto error = [](const std::string& words) {
    const auto made = make_shape(*parse_shape(words), true);
    return made ? "" : made.error().message;
  };
  EXPECT_EQ(error("superquadric north=1e9"),
            "`north` of superquadric is 1e+09, and goes from 0.05 to 4");
  EXPECT_EQ(error("superquadric east=4.01"),
            "`east` of superquadric is 4.01, and goes from 0.05 to 4");
  EXPECT_EQ(error("superquadric north=0.04"),
            "`north` of superquadric is 0.04, and goes from 0.05 to 4");
  EXPECT_EQ(error("superquadric north=nan"),
            "`north` of superquadric is nan, and goes from 0.05 to 4");
  EXPECT_EQ(error("superquadric north=4 east=0.05"), "");
  EXPECT_EQ(error("sphere radius=0"), "`radius` of sphere is 0, and goes from 1e-06 up");
  EXPECT_EQ(error("sphere radius=1e9"), "");
}

}  // namespace
}  // namespace pse::surface
