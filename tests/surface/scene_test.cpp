// Scenes of many objects, and that a hit depends on its ray alone.
#include <gtest/gtest.h>

#include <numbers>

#include "rays.h"
#include "surface/mesh.h"
#include "surface/scene.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

Affine moved(const Vec3& offset) {
  Affine map;
  map.offset = offset;
  return map;
}

// Balls scattered through a cube, some within each other; the same at every run.
std::vector<Object> thousand_balls() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Object> objects;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 centre{uniform(random), uniform(random), uniform(random)};
    objects.push_back({"ball", make_sphere(0.02 + 0.03 * std::abs(uniform(random))),
                       moved(centre), 0});
  }
  return objects;
}

// The sphere's formula, ball by ball.
std::pair<double, int> nearest_ball(const std::vector<Object>& balls, const Ray& ray) {
  std::pair<double, int> best{Box::inf, -1};
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const double radius = 0.5 * (balls[k].shape->bounds().upper.x - balls[k].shape->bounds().lower.x);
    const Vec3 from = ray.origin - balls[k].to_world.offset;
    const double b = dot(from, ray.direction), c = dot(from, from) - radius * radius;
    if (b * b < c) continue;
    for (const double t : {-b - std::sqrt(b * b - c), -b + std::sqrt(b * b - c)})
      if (t > ray.begin && t < best.first) best = {t, static_cast<int>(k)};
  }
  return best;
}

TEST(Scenes, AThousandBallsAreMetAsOneByOne) {
  const std::vector<Object> balls = thousand_balls();
  const Scene scene(balls, {});
  std::vector<Ray> rays = rays_inward(3000, 3);
  for (Ray& ray : rays_inward(1000, 0.5, 2)) rays.push_back(ray);  // from amid the balls
  std::vector<Hit> hits(rays.size());
  scene.trace(rays, hits);
  std::size_t met = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto [t, ball] = nearest_ball(balls, rays[i]);
    ASSERT_EQ(hits[i].object, ball) << i;
    if (ball < 0) continue;
    ++met;
    ASSERT_NEAR(hits[i].t(), t, 1e-9);
  }
  EXPECT_GT(met, 2000u);
}

// Rays that touch balls where these touch their boxes: a box a little too small would hide them.
TEST(Scenes, BallsAreMetAtTheFacesOfTheirBoxes) {
  const std::vector<Object> balls = thousand_balls();
  for (std::size_t i = 0; i < 50; ++i) {
    const Scene scene({balls[i], balls[i + 50]}, {});
    const double inside = balls[i].shape->bounds().upper.x * (1 - 1e-7);
    for (const Vec3& pole : {Vec3{0, inside, 0}, Vec3{0, -inside, 0}, Vec3{0, 0, inside},
                             Vec3{0, 0, -inside}}) {
      const Ray ray{balls[i].to_world.offset + pole - Vec3{5, 0, 0}, {1, 0, 0}};
      Hit hit;
      scene.trace({&ray, 1}, {&hit, 1});
      EXPECT_GE(hit.object, 0) << i;
    }
  }
}

TEST(Scenes, OfTwoInTheSamePlaceTheFirstIsSeen) {
  const auto ball = make_sphere(1);
  const Scene scene({{"one", ball, {}, 0}, {"two", ball, {}, 0}, {"floor", make_plane(Box::inf), {}, 0}},
                    {});
  for (const double side : {-1.0, 1.0}) {
    const Ray ray{{side * 5, 0.2, 0.1}, {-side, 0, 0}};
    Hit hit;
    scene.trace({&ray, 1}, {&hit, 1});
    EXPECT_EQ(hit.object, 0);
  }
}

// Straight down and straight up X stays to the right; a slanted `up` along the view has no upright.
TEST(Cameras, LookStraightUpAndDown) {
  for (const double side : {-1.0, 1.0}) {
    const Camera camera{.eye = {0, 5 * side, 0}};
    ASSERT_TRUE(camera.has_upright());
    const Lens lens(camera, 100, 100);
    EXPECT_EQ(lens.right(), (Vec3{1, 0, 0}));
    EXPECT_NEAR(lens.ray(50, 50).direction.y, -side, 1e-12);
  }
  EXPECT_FALSE((Camera{.eye = {0, 0, 5}, .up = {0, 0, 2}}.has_upright()));
}

// Rays along the axes, on the faces of boxes, and ones that are no rays at all.
TEST(Scenes, RaysAlongFacesAndBrokenRays) {
  const Scene scene({{"a", make_box({2, 2, 2}), moved({-2, 0, 0}), 0},
                     {"b", make_box({2, 2, 2}), moved({2, 0, 0}), 0}}, {});
  const double nan = std::nan(""), inf = Box::inf;
  const std::vector<Ray> rays = {{{-2, 1, 5}, {0, 0, -1}}, {{-2, 0, 5}, {0, 0, -1}},
                                 {{9, 0, 0}, {-1, 0, 0}},  {{0, 0, 0}, {0, 0, 0}},
                                 {{nan, 0, 0}, {0, 0, 1}}, {{0, 0, 5}, {inf, 0, -1}}};
  std::vector<Hit> hits(rays.size());
  scene.trace(rays, hits);
  EXPECT_EQ(hits[1].object, 0);
  EXPECT_EQ(hits[2].object, 1);
  EXPECT_NEAR(hits[2].t(), 6, 1e-12);
  for (std::size_t i = 3; i < rays.size(); ++i) EXPECT_FALSE(hits[i].found()) << i;
}

// However many rays there are together, and in which order: the same bits.
void expect_alone_as_together(const Scene& scene, const std::vector<Ray>& rays) {
  std::vector<Hit> together(rays.size());
  scene.trace(rays, together);
  std::vector<Ray> reversed(rays.rbegin(), rays.rend());
  reversed.pop_back();
  std::vector<Hit> back(reversed.size());
  scene.trace(reversed, back);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit alone;
    scene.trace({&rays[i], 1}, {&alone, 1});
    const auto expect_same = [&](const Hit& other) {
      ASSERT_EQ(alone.object, other.object) << i;
      ASSERT_EQ(alone.meeting.part, other.meeting.part) << i;
      ASSERT_EQ(alone.t(), other.t()) << i;
      ASSERT_EQ(alone.meeting.a, other.meeting.a) << i;
      ASSERT_EQ(alone.meeting.b, other.meeting.b) << i;
    };
    expect_same(together[i]);
    if (i > 0) expect_same(back[rays.size() - 1 - i]);
  }
  // In companies of 1 to 40: packets that are full, that are not, and of more than one width.
  std::vector<Hit> parted(rays.size());
  for (std::size_t begin = 0, count = 1; begin < rays.size();
       begin += count, count = count % 40 + 1) {
    count = std::min(count, rays.size() - begin);
    scene.trace(std::span(rays).subspan(begin, count), std::span(parted).subspan(begin, count));
    for (std::size_t i = begin; i < begin + count; ++i) {
      ASSERT_EQ(parted[i].object, together[i].object) << i << " of " << count;
      ASSERT_EQ(parted[i].meeting.part, together[i].meeting.part) << i << " of " << count;
      ASSERT_EQ(parted[i].t(), together[i].t()) << i << " of " << count;
    }
  }
}

TEST(Scenes, AHitOfShapesDependsOnItsRayAlone) {
  std::vector<Object> objects = {{"vase", make_revolution(vase_profile(), false), {}, 0},
                                 {"ring", make_torus(0.8, 0.3), moved({0.3, 0, 0}), 0},
                                 {"stone", make_superquadric({0.9, 0.8, 0.7}, 0.3, 0.4), {}, 0},
                                 {"floor", make_plane(Box::inf), moved({0, -0.9, 0}), 0}};
  expect_alone_as_together(Scene({objects[0]}, {}), rays_inward(3000, 3));
  expect_alone_as_together(Scene(objects, {}), rays_inward(3000, 3));
}

// Sheets in one plane, each of several triangles, some twice and turned over: at every place several
// triangles are at the same distance.
TEST(Scenes, AHitOfAMeshDependsOnItsRayAlone) {
  if (!PSE_HAS_MESHES) GTEST_SKIP() << "built without meshes";
  auto mesh = std::make_shared<Mesh>();
  for (int sheet = 0; sheet < 9; ++sheet) {
    const float x = static_cast<float>(sheet % 3) * 0.25f - 1, y = static_cast<float>(sheet / 3) * 0.25f - 1;
    const auto first = static_cast<std::uint32_t>(mesh->vertex_count());
    for (const auto& [u, v] : {std::pair{0.f, 0.f}, {1.5f, 0.f}, {1.5f, 1.5f}, {0.f, 1.5f}})
      mesh->positions.insert(mesh->positions.end(), {x + u, y + v, 0.25f});
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u, 0u, 3u, 2u})
      mesh->triangles.push_back(first + corner);
  }
  const auto shape = make_mesh_shape(mesh);
  ASSERT_TRUE(shape) << shape.error();
  std::vector<Ray> rays = rays_inward(4000, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      rays.push_back({{-1 + x / 32.0, -1 + y / 32.0, 2}, {0, 0, -1}});
  expect_alone_as_together(Scene({{"sheets", *shape, {}, 0}}, {}), rays);
}

// Numbers that Embree does not take: from so far away nothing is met, alone and in company; a
// direction may be as long as it likes.
TEST(Scenes, RaysFromFarAwayAndLongOnesAtAMesh) {
  if (!PSE_HAS_MESHES) GTEST_SKIP() << "built without meshes";
  auto mesh = std::make_shared<Mesh>();
  mesh->positions = {-1, -1, 0, 1, -1, 0, 0, 1, 0};
  mesh->triangles = {0, 1, 2};
  const auto shape = make_mesh_shape(mesh);
  ASSERT_TRUE(shape) << shape.error();
  const Scene scene({{"face", *shape, {}, 0}}, {});
  std::vector<Ray> rays;
  for (const double far : {1e17, 1e19, 1e30, 1e200}) rays.push_back({{0, 0, far}, {0, 0, -1}});
  for (const double length : {1e-15, 1e-6, 1.0, 1e19, 1e60})
    rays.push_back({{0, 0, 2}, {0, 0, -length}});
  for (int i = 0; i < 9; ++i) rays.push_back({{0, 0, 3}, {0, 0, -1}});
  std::vector<Hit> hits(rays.size());
  scene.trace(rays, hits);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_FALSE(hits[i].found()) << i;
  for (std::size_t i = 4; i < 9; ++i) {
    ASSERT_TRUE(hits[i].found()) << i;
    EXPECT_NEAR(hits[i].t() * length(rays[i].direction), 2, 1e-9) << i;
  }
  for (std::size_t i = 9; i < rays.size(); ++i) EXPECT_NEAR(hits[i].t(), 3, 1e-12) << i;
  expect_alone_as_together(scene, rays);
}

// All triangles of a ball that is there twice: of each pair, the one with the lower number is met,
// by rays alone and in packets of either width.
TEST(Scenes, OfTwoEqualTrianglesTheFirstIsMet) {
  if (!PSE_HAS_MESHES) GTEST_SKIP() << "built without meshes";
  constexpr int rings = 24, sides = 48;
  auto mesh = std::make_shared<Mesh>();
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < sides; ++k) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * k / sides;
      for (const double c : {std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)})
        mesh->positions.push_back(static_cast<float>(c));
    }
  for (int copy = 0; copy < 2; ++copy)
    for (int i = 0; i < rings; ++i)
      for (int k = 0; k < sides; ++k) {
        const int next = (k + 1) % sides;
        for (const int corner : {i * sides + k, i * sides + next, (i + 1) * sides + k})
          mesh->triangles.push_back(static_cast<std::uint32_t>(corner));
        for (const int corner : {i * sides + next, (i + 1) * sides + next, (i + 1) * sides + k})
          mesh->triangles.push_back(static_cast<std::uint32_t>(corner));
      }
  const auto shape = make_mesh_shape(mesh);
  ASSERT_TRUE(shape) << shape.error();
  const Scene scene({{"ball", *shape, {}, 0}}, {});
  const std::vector<Ray> rays = rays_inward(3000, 3);
  std::vector<Hit> hits(rays.size());
  for (const std::size_t company : {1, 5, 8, 12, 16, 48}) {
    std::size_t found = 0;
    for (std::size_t begin = 0; begin < rays.size(); begin += company) {
      const std::size_t count = std::min(company, rays.size() - begin);
      scene.trace(std::span(rays).subspan(begin, count), std::span(hits).subspan(begin, count));
    }
    for (const Hit& hit : hits) {
      if (!hit.found()) continue;
      ++found;
      EXPECT_LT(hit.meeting.part, mesh->triangle_count() / 2) << "in companies of " << company;
    }
    EXPECT_GT(found, 500u);
  }
}

// Those of many places at once are those of each.
TEST(Cameras, RaysOfManyPlacesAreThoseOfEach) {
  Camera camera;
  camera.eye = {1, 2, 5};
  for (const double height : {0.0, 3.0}) {
    camera.height = height;
    const Lens lens(camera, 40, 30);
    std::vector<double> x, y;
    std::vector<std::uint32_t> which;
    for (std::uint32_t i = 0; i < 100; ++i)
      x.push_back(0.37 * i), y.push_back(30 - 0.29 * i), which.push_back(99 - i);
    std::vector<Ray> rays(which.size());
    lens.rays(x, y, which, rays);
    for (std::size_t k = 0; k < which.size(); ++k) {
      const Ray one = lens.ray(x[which[k]], y[which[k]]);
      EXPECT_EQ(rays[k].origin, one.origin);
      EXPECT_EQ(rays[k].direction, one.direction);
    }
  }
}

}  // namespace
}  // namespace pse::surface
