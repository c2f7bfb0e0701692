// Where a ray meets something, the cover says so; and it is not much larger than what is seen.
#include "surface/cover.h"

#include <gtest/gtest.h>

#include <random>

#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr int width = 320, height = 240;

struct Seen {
  double shown = 0, covered = 0;  // parts of the places looked at
};

// At places in each pixel, its corners among them; fails where something is shown but not covered.
Seen compare(const Scene& scene, const Lens& lens) {
  const Cover cover(scene, lens);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> within(0, 1);
  std::vector<Ray> rays;
  std::vector<bool> covered;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const auto& [right, down] : {std::pair{0.0, 0.0}, {within(random), within(random)}}) {
        rays.push_back(lens.ray(x + right, y + down));
        covered.push_back(cover.may_show(x + right, y + down));
      }
  std::vector<Hit> hits(rays.size());
  scene.trace(rays, hits);
  Seen seen;
  int lost = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    seen.shown += hits[i].found() ? 1 : 0;
    seen.covered += covered[i] ? 1 : 0;
    lost += hits[i].found() && !covered[i] ? 1 : 0;
  }
  EXPECT_EQ(lost, 0);
  return {seen.shown / double(rays.size()), seen.covered / double(rays.size())};
}

Object placed(std::shared_ptr<const Shape> shape, const Affine& map = {}) {
  return {"object", std::move(shape), map, 0};
}

TEST(Covers, HoldTheVaseAndLittleElse) {
  const Scene scene({placed(make_revolution(vase_profile(), false))}, {});
  const Seen seen = compare(scene, Lens(framing(scene.bounds(), 4.0 / 3, 30), width, height));
  EXPECT_GT(seen.shown, 0.1);
  EXPECT_LT(seen.covered, 1.5 * seen.shown);  // cells of 8 pixels in a picture of 240
}

TEST(Covers, HoldEveryShapeFromEverywhere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  const std::vector<std::shared_ptr<const Shape>> shapes = {
      make_sphere(0.7),
      make_box({1, 0.2, 0.6}),
      make_plane(1.5),
      make_torus(0.6, 0.15),
      make_superquadric({0.3, 0.9, 0.5}, 0.4, 1.7),
      make_revolution({{0.5, -0.6}, {0.1, 0}, {0.7, 0.5}}, true),
      make_revolution({{0, -0.5}, {0.6, -0.5}, {0, 0.7}}, false)};
  double shown = 0, covered = 0;
  for (const auto& shape : shapes)
    for (int view = 0; view < 6; ++view) {
      const Affine map{any(), any(), any(), any()};
      Camera camera;
      camera.eye = 4.0 * any(), camera.target = any(), camera.fov = view == 1 ? 150 : 40;
      camera.height = view == 0 ? 3 : 0;
      const Seen seen = compare(Scene({placed(shape, map), placed(make_sphere(0.05))}, {}),
                                Lens(camera, width, height));
      shown += seen.shown, covered += seen.covered;
    }
  EXPECT_GT(shown, 1);
  EXPECT_LT(covered, 20);
}

TEST(Covers, AreEverythingFromWithinAndWhereThereIsNoEnd) {
  Camera camera;
  camera.eye = {0, 0.5, 0.2};
  const Lens lens(camera, width, height);
  EXPECT_EQ(compare(Scene({placed(make_torus(2, 1))}, {}), lens).covered, 1);
  camera.eye = {0, 3, 9};
  EXPECT_EQ(compare(Scene({placed(make_plane(Box::inf))}, {}), Lens(camera, width, height)).covered,
            1);
}

TEST(Covers, AreNothingWhereNothingIs) {
  Camera camera;
  camera.eye = {0, 0, 9}, camera.target = {9, 0, 9};
  EXPECT_EQ(compare(Scene({}, {}), Lens(camera, width, height)).covered, 0);
  Affine aside;
  aside.offset = {9, 60, 9};
  EXPECT_EQ(
      compare(Scene({placed(make_sphere(1), aside)}, {}), Lens(camera, width, height)).covered, 0);
}

}  // namespace
}  // namespace pse::surface
