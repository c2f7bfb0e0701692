// `pse bake PROGRAM MESH`: a program over a mesh's texture atlas, against closed forms and against
// the program itself on the mesh.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "run_pse.h"

namespace pse::test {
namespace {

namespace fs = std::filesystem;

class BakeAtlas : public CommandLine {
 protected:
  // The square [-1, 1]^2 in the plane z = 0, whose texture coordinates fill [low, high]^2.
  void make_square(const std::string& name, double low, double high) {
    std::string text = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
    for (const auto& [u, v] : {std::pair{low, low}, {high, low}, {high, high}, {low, high}})
      text += "vt " + std::to_string(u) + " " + std::to_string(v) + "\n";
    file(name, text + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  }
  float at(const image::Image& image, const std::string& channel, int x, int y) {
    const int index = image.spec.find(channel);
    EXPECT_GE(index, 0) << channel;
    return index < 0 ? NAN : image.at(index, x, y);
  }
  Ended bake(const std::string& mesh, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"bake",  "a.pse", mesh, "-o",
                                      "a.exr", "--res", "20", "--float"};
    words.insert(words.end(), more.begin(), more.end());
    return pse(words);
  }
};

TEST_F(BakeAtlas, EachTexelSeesItsPointOfTheSurface) {
  make_square("square.obj", 0.1, 0.9);
  file("a.pse", "P = point\nN = normal\nplace_uv = uv\nside = pixelsize\n");
  const Ended ended = bake("square.obj fit=false", {"--dilate", "0"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const image::Image made = picture("a.exr");
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      // A texel's centre; the charts reach from texel 2 to 17.
      const double u = (x + 0.5) / 20, v = 1 - (y + 0.5) / 20;
      const bool inside = x >= 2 && x < 18 && y >= 2 && y < 18;
      EXPECT_NEAR(at(made, "P.X", x, y), inside ? (u - 0.5) / 0.4 : 0, 1e-5) << x << " " << y;
      EXPECT_NEAR(at(made, "P.Y", x, y), inside ? (v - 0.5) / 0.4 : 0, 1e-5);
      EXPECT_NEAR(at(made, "place_uv.V", x, y), inside ? v : 0, 1e-6);
      EXPECT_NEAR(at(made, "N.Z", x, y), inside ? 1 : 0, 1e-6);
      EXPECT_NEAR(at(made, "side.Y", x, y), inside ? 2.0 / 16 : 0, 1e-6);
    }
  }
}

TEST_F(BakeAtlas, EdgesAreCoveredAndColoursReachBeyond) {
  // Charts that end within texels 2 and 17: those texels show the nearest point, the edge.
  make_square("square.obj", 0.13, 0.87);
  file("a.pse", "P = point\n");
  ASSERT_EQ(bake("square.obj fit=false", {"--dilate", "0"}).status, 0);
  image::Image made = picture("a.exr");
  EXPECT_NEAR(at(made, "P.X", 2, 10), -1, 1e-5);
  EXPECT_EQ(at(made, "P.X", 1, 10), 0);
  ASSERT_EQ(bake("square.obj fit=false", {"--dilate", "2"}).status, 0);
  made = picture("a.exr");
  EXPECT_NEAR(at(made, "P.X", 1, 10), -1, 1e-5);
  EXPECT_NEAR(at(made, "P.X", 0, 10), -1, 1e-5);
  EXPECT_NEAR(at(made, "P.X", 0, 0), -1, 0.05);
  // Further out nothing.
  make_square("square.obj", 0.4, 0.6);
  ASSERT_EQ(bake("square.obj fit=false", {"--dilate", "2"}).status, 0);
  EXPECT_EQ(at(picture("a.exr"), "P.X", 1, 10), 0);
}

TEST_F(BakeAtlas, SamplesAreAveraged) {
  make_square("square.obj", 0, 1);
  // Half of texel (0, y) is white: u < 0.025.
  file("a.pse", "stripe = u < 0.025\n");
  ASSERT_EQ(bake("square.obj").status, 0);
  const float one = at(picture("a.exr"), "stripe.Y", 0, 5);
  ASSERT_EQ(bake("square.obj", {"--samples", "16"}).status, 0);
  EXPECT_EQ(at(picture("a.exr"), "stripe.Y", 0, 5), 0.5f);
  EXPECT_EQ(at(picture("a.exr"), "stripe.Y", 1, 5), 0.0f);
  EXPECT_NE(one, 0.5f);
}

TEST_F(BakeAtlas, ChartsThatLeaveTheSquareComeInOnTheOtherSide) {
  make_square("square.obj", -0.25, 0.75);
  file("a.pse", "P = point\n");
  ASSERT_EQ(bake("square.obj fit=false").status, 0);
  const image::Image made = picture("a.exr");
  // u = 0.975 of the texture is -0.025 of the mesh: x = -1 + 2 * 0.225.
  EXPECT_NEAR(at(made, "P.X", 19, 10), -0.55, 1e-5);
  EXPECT_NEAR(at(made, "P.X", 0, 10), -0.45, 1e-5);
}

TEST_F(BakeAtlas, TilesAndOverlaps) {
  file("a.pse", "P = point\n");
  // A square in each of two tiles.
  const std::string corners =
      "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 5\nv 1 -1 5\n"
      "v 1 1 5\nv -1 1 5\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  const std::string faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  file("two.obj",
       corners + "vt 1 0\nvt 2 0\nvt 2 1\nvt 1 1\n" + faces + "f 5/5 6/6 7/7\nf 5/5 7/7 8/8\n");
  Ended ended = bake("two.obj fit=false");
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "several tiles (1001, 1002)"));
  ASSERT_EQ(bake("two.obj fit=false", {"--udim", "1002"}).status, 0);
  EXPECT_EQ(at(picture("a.exr"), "P.Z", 10, 10), 5);
  ended = bake("two.obj fit=false", {"--udim", "1011"});
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "nothing in tile 1011"));
  file("other.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 1 0\nvt 2 0\nvt 2 1\nf 1/1 2/2 3/3\n");
  EXPECT_TRUE(contains(bake("other.obj").err, "lie in another tile than 1001 (1002)"));
  // Both in the same place: a warning.
  file("same.obj", corners + faces + "f 5/1 6/2 7/3\nf 5/1 7/3 8/4\n");
  ended = bake("same.obj fit=false");
  EXPECT_EQ(ended.status, 0);
  EXPECT_TRUE(contains(ended.err, "texture coordinates overlap"));
}

TEST_F(BakeAtlas, WhatIsWrongIsSaid) {
  file("a.pse", "color = white * point.x\n");
  const Ended no_mesh = bake("sphere");
  EXPECT_EQ(no_mesh.status, 2);
  EXPECT_TRUE(contains(no_mesh.err, "`sphere` is no mesh")) << no_mesh.err;
  file("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Ended ended = bake("bare.obj");
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "has no texture coordinates (UVs)"));
  EXPECT_EQ(bake("nowhere.obj").status, 4);
  make_square("square.obj", 0, 1);
  EXPECT_EQ(bake("square.obj size=3").status, 2);
  file("a.pse", "color = white * light_direction\n");
  EXPECT_EQ(bake("square.obj").status, 3);
}

TEST_F(BakeAtlas, TheBakedTextureLooksLikeTheProgram) {
  const fs::path spot = fs::path(PSE_SOURCE_DIR) / "../shared/data/spot.obj";
  if (!fs::exists(spot)) GTEST_SKIP() << "needs ../shared/data/spot.obj";
  file("solid.pse", "color = 0.5 + 0.4 * [Noise(3 * point), Noise(3 * point + 7), point.y]\n");
  Ended ended =
      pse({"bake", "solid.pse", spot.string(), "-o", "solid.exr", "--res", "512", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  file("compare.pse",
       "a = texture(\"solid.exr\", uv)\n"
       "b = 0.5 + 0.4 * [Noise(3 * point), Noise(3 * point + 7), point.y]\n"
       "apart = hit * max(abs(a - b))\nseen = hit\n");
  ended = pse({"render", "compare.pse", "--on", spot.string(), "-o", "compare.exr", "--res", "128",
               "--float", "--antialias", "none"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const image::Image made = picture("compare.exr");
  const auto& apart = made.planes[static_cast<std::size_t>(made.spec.find("apart.Y"))];
  const auto& seen = made.planes[static_cast<std::size_t>(made.spec.find("seen.Y"))];
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < apart.size(); ++i) sum += apart[i], count += seen[i];
  EXPECT_GT(count, 1000);
  EXPECT_LT(sum / count, 0.004);
  // At seams a texel mixes both sides of a chart's edge; nowhere is it black.
  EXPECT_LT(*std::max_element(apart.begin(), apart.end()), 0.15f);
}

}  // namespace
}  // namespace pse::test
