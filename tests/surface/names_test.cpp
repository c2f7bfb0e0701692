// Names of many samples at once: the same bits for any processor, alone or in company; and rows of
// samples that find their way to their programs and back.
#include <gtest/gtest.h>

#include <cstring>

#include "../stream/fake_program.h"
#include "rays.h"
#include "surface/name_values.h"
#include "surface/shader.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr std::size_t most = 64;
using Plane = std::array<float, most>;
using All = std::array<std::array<Plane, 3>, computed_count>;

// What rays meet on a turned and stretched torus, its computed names by `function`.
struct Scenery {
  Frame frame;
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<ShapePoint> points;
  std::vector<Sighting> sightings;

  Scenery() {
    const Affine to_world{{0.8, 0.6, 0}, {-0.9, 1.2, 0}, {0, 0, 0.7}, {0.3, -0.2, 0.1}};
    const Scene scene({{"ring", make_torus(0.7, 0.3), to_world, 0}}, {});
    frame = scene.frame(0);
    for (const Ray& ray : rays_inward(400, 3)) {
      Hit hit;
      scene.trace({&ray, 1}, {&hit, 1});
      if (!hit.found() || rays.size() == 37) continue;
      const auto k = static_cast<std::uint32_t>(rays.size());
      // Rows of four, and samples by themselves.
      sightings.push_back({k < 16 ? k : (k * 7 + 20) % 48 + 16, 0.01 + 0.001 * k, 2.0 + k});
      rays.push_back(ray), hits.push_back(hit);
    }
    points.resize(hits.size());
    scene.describe_own(rays, hits, true, points);
    points[5].flat = points[5].normal + Vec3{0.1, 0, 0.2};  // as on meshes
  }

  void run(NameFunction function, std::size_t first, std::size_t count, All& all) const {
    std::vector<NameStore> stores;
    for (std::size_t what = 0; what < computed_count; ++what)
      for (int c = 0; c < 3; ++c)
        if (has(what, c)) stores.push_back({all[what][c].data(), static_cast<What>(what), c, 0});
    function({.count = count,
              .sightings = &sightings[first],
              .rays = &rays[first],
              .hits = &hits[first],
              .points = &points[first],
              .frame = frame,
              .right = {1, 0, 0},
              .up = {0, 1, 0},
              .wants_shifts = true,
              .is_background = false,
              .stores = stores.data(),
              .store_count = stores.size(),
              .places = {}});
  }
  // Numbers have one component.
  static bool has(std::size_t what, int component) {
    using enum What;
    for (const What number : {depth, backface, pixelsize, pixel_freq})
      if (what == static_cast<std::size_t>(number)) return component == 0;
    return true;
  }
};

TEST(Names, DoNotDependOnProcessorOrCompany) {
  const Scenery scenery;
  ASSERT_EQ(scenery.rays.size(), 37u);
  All expected{}, other{};
  scenery.run(names_for_any(), 0, 37, expected);
  const auto expect_same = [&](const char* what) {
    EXPECT_EQ(std::memcmp(&expected, &other, sizeof(All)), 0) << what;
    other = {};
  };
  for (const NameFunction function : {names_for_any(), name_function()}) {
    scenery.run(function, 0, 37, other);
    expect_same("together");
    for (std::size_t k = 0; k < 37; ++k) scenery.run(function, k, 1, other);
    expect_same("alone");
    scenery.run(function, 0, 3, other), scenery.run(function, 3, 34, other);
    expect_same("in other company");
  }
}

// The place as the ray says it, the normal of a scene's description, the pixel's step along the
// tangent plane: across the ray it is one pixel wide.
TEST(Names, AreWhatTheyAreCalled) {
  const Scenery scenery;
  All all{};
  scenery.run(name_function(), 0, 37, all);
  for (std::size_t k = 0; k < 37; ++k) {
    const std::uint32_t i = scenery.sightings[k].sample;
    const auto at = [&](What what) {
      const auto& planes = all[static_cast<std::size_t>(what)];
      return Vec3{planes[0][i], planes[1][i], planes[2][i]};
    };
    const Ray& ray = scenery.rays[k];
    const Vec3 place = ray.origin + scenery.hits[k].t() * ray.direction;
    EXPECT_LT(length(at(What::place) - place), 1e-6);
    const Vec3 point = scenery.frame.to_object.point(place);
    EXPECT_LT(length(at(What::point) - point), 1e-6);
    const double r = std::hypot(point.x, point.z);
    const Vec3 own = point - (0.7 / r) * Vec3{point.x, 0, point.z};
    const Vec3 normal = normalized(scenery.frame.to_object.transposed(own));
    EXPECT_LT(length(at(What::normal) - normal), 1e-5) << k;
    EXPECT_EQ(at(What::backface).x, 0);
    if (k == 5) continue;
    const double facing = -dot(normal, ray.direction);
    if (facing < 0.05) continue;
    const Vec3 step = at(What::place_dx), across = step - dot(step, ray.direction) * ray.direction;
    EXPECT_NEAR(length(across), scenery.sightings[k].width, 1e-5);
    EXPECT_NEAR(dot(step, normal), 0, 1e-5);
    EXPECT_LT(length(at(What::dpdx) - scenery.frame.to_object.vector(step)), 1e-6);
  }
}

// Rows of all lengths; each program numbers its samples from its own number on.
TEST(Shader, RowsComeBackToTheirPlaces) {
  const auto numbers = [](float own) {
    auto program = std::make_shared<Program>(test::fake_program(
        {{"id"}}, {"color"}, [own](auto, auto out, std::int64_t count, RunStatus& status) {
          for (std::int64_t i = 0; i < count; ++i) out[0][i] = own + static_cast<float>(i);
          if (own == 9000) status.failed_check = 0, status.failed_sample = 50;
        }));
    program->outputs = {ProgramOutput{"color", 1, {}}};
    return std::shared_ptr<const Program>(program);
  };
  std::vector<float> ids;
  for (int row = 0; row < 60; ++row)
    ids.insert(ids.end(), static_cast<std::size_t>(row * 37 % 53 + 1),
               static_cast<float>(row * 7 % 4));
  std::vector<float> color(ids.size()), alpha(ids.size());
  const float* const in[] = {ids.data()};
  float* const out[] = {color.data(), alpha.data()};
  const auto run = [&](float second, RunStatus& status) {
    Scratch scratch;
    const Shader shader({numbers(1000), numbers(second)}, {-1, 0, 1, 0});
    shader.run_samples({}, status, scratch, in, out, static_cast<std::int64_t>(ids.size()));
  };
  RunStatus status;
  run(5000, status);
  float first = 1000, second = 5000;
  std::vector<std::uint32_t> of_second;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (ids[i] == 2) of_second.push_back(static_cast<std::uint32_t>(i));
    ASSERT_EQ(color[i], ids[i] == 0 ? 0 : ids[i] == 2 ? second++ : first++) << i;
    ASSERT_EQ(alpha[i], ids[i] == 0 ? 0 : 1) << i;
  }
  run(9000, status);
  EXPECT_EQ(status.failed_check, 0);
  EXPECT_EQ(status.failed_sample, of_second[50]);
}

}  // namespace
}  // namespace pse::surface
