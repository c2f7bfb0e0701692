// Several rays at once against a surface of revolution: each gets the answer that it gets alone, on
// any processor, and that is where a straight profile, a cone, is known to be.
#include <gtest/gtest.h>

#include <optional>

#include "rays.h"
#include "surface/revolution.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

std::vector<Meeting> meetings_of(const Shape& shape, std::span<const Ray> rays) {
  std::vector<Meeting> meetings(rays.size());
  shape.find(rays, meetings);
  return meetings;
}

void expect_same(const Meeting& a, const Meeting& b, std::size_t ray) {
  EXPECT_EQ(a.t, b.t) << ray;
  EXPECT_EQ(a.a, b.a) << ray;
  EXPECT_EQ(a.part, b.part) << ray;
}

// Rays that go through all of the code: from outside and inside, level, through the axis, past it.
std::vector<Ray> mixed_rays() {
  std::vector<Ray> rays = rays_inward(3000, 3, 11);
  const std::vector<Ray> inside = rays_inward(600, 0.4, 12);
  rays.insert(rays.end(), inside.begin(), inside.end());
  for (std::size_t i = 0; i < rays.size(); i += 5) rays[i].direction.y = i % 2 == 0 ? 0 : 1e-6;
  for (std::size_t i = 3; i < rays.size(); i += 17) {
    rays[i].origin.z = rays[i].direction.z = 0;
    if (i % 3 == 0) rays[i].origin.x = rays[i].direction.x = 0;
    if (rays[i].direction == Vec3{}) rays[i].direction.y = 1;
  }
  return rays;
}

TEST(Revolution, AMeetingDependsOnItsRayAlone) {
  const auto vase = make_revolution(vase_profile(), true);
  const std::vector<Ray> rays = mixed_rays();
  const std::vector<Meeting> together = meetings_of(*vase, rays);
  const std::vector<Ray> turned(rays.rbegin(), rays.rend());
  const std::vector<Meeting> backwards = meetings_of(*vase, turned);
  std::size_t found = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Meeting alone;
    vase->find({&rays[i], 1}, {&alone, 1});
    expect_same(together[i], alone, i);
    expect_same(backwards[rays.size() - 1 - i], alone, i);
    found += alone.found() ? 1 : 0;
  }
  EXPECT_GT(found, rays.size() / 4);
}

TEST(Revolution, AMeetingDoesNotDependOnTheProcessor) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") == 0) GTEST_SKIP() << "no AVX2 here";
#endif
  const auto any = revolution::make_for(vase_profile(), true, revolution::find_for_any());
  const auto avx2 = revolution::make_for(vase_profile(), true, revolution::find_for_avx2());
  const std::vector<Ray> rays = mixed_rays();
  const std::vector<Meeting> first = meetings_of(*any, rays), second = meetings_of(*avx2, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) expect_same(first[i], second[i], i);
}

// Where a ray first meets the radius 0.9 - 0.75 (y + 0.6) between the heights -0.6 and 0.4, by the
// quadratic.
std::optional<double> meets_cone(const Ray& ray) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  const double r = 0.45 - 0.75 * o.y, s = -0.75 * d.y;
  const double a = d.x * d.x + d.z * d.z - s * s, b = o.x * d.x + o.z * d.z - r * s,
               c = o.x * o.x + o.z * o.z - r * r;
  if (b * b < a * c) return {};
  std::optional<double> first;
  for (const double side : {-1.0, 1.0}) {
    const double t = (-b + side * std::sqrt(b * b - a * c)) / a, y = o.y + t * d.y;
    if (t > 0 && y >= -0.6 && y <= 0.4 && (!first || t < *first)) first = t;
  }
  return first;
}

TEST(Revolution, AStraightProfileIsACone) {
  const auto cone = make_revolution({{0.9, -0.6}, {0.6, -0.2}, {0.3, 0.2}, {0.15, 0.4}}, false);
  const std::vector<Ray> rays = rays_inward(8000, 3, 21);
  const std::vector<Meeting> meetings = meetings_of(*cone, rays);
  std::size_t found = 0, differ = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::optional<double> exact = meets_cone(rays[i]);
    if (exact.has_value() != meetings[i].found()) {
      ++differ;  // on the very rim
      continue;
    }
    if (!exact) continue;
    ++found;
    EXPECT_NEAR(meetings[i].t, *exact, 1e-8) << i;
  }
  EXPECT_GT(found, 3000u);
  EXPECT_LE(differ, 2u);
}

// A cone of radius 1.25 + h / 2 that is met exactly at a point of its profile, where two pieces
// join, or half way along one: 0.75^2 + 1 = 1.25^2, and nothing is rounded.
TEST(Revolution, IsClosedWhereItsPiecesJoin) {
  const std::vector<std::vector<ProfilePoint>> profiles = {
      {{0.75, -1}, {1, -0.5}, {1.25, 0}, {1.5, 0.5}, {1.75, 1}},
      {{1.75, 1}, {1.5, 0.5}, {1.25, 0}, {1, -0.5}, {0.75, -1}},
      {{0.75, -1}, {1, -0.5}, {1.5, 0.5}, {1.75, 1}}};
  std::vector<Ray> rays;
  for (const int from : {-1, 1})
    for (int up = -64; up <= 64; ++up)
      for (const double far : {1.0, 2.0, 3.0, 4.0})
        rays.push_back(
            {{from * (0.75 + far), up / 64.0 * far, from * 1.0}, {from * -1.0, -up / 64.0, 0}});
  for (std::size_t profile = 0; profile < profiles.size(); ++profile) {
    const auto cone = make_revolution(profiles[profile], false);
    const std::vector<Meeting> meetings = meetings_of(*cone, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double far = std::abs(rays[i].origin.x) - 0.75;
      EXPECT_NEAR(meetings[i].t, far, 1e-9) << profile << " " << i;
    }
  }
}

}  // namespace
}  // namespace pse::surface
