// What `pse render` makes of image files: other formats, windows, colour spaces, textures and
// environments.
#include <cmath>
#include <filesystem>

#include "run_pse.h"

namespace pse::test {
namespace {

class RenderImages : public CommandLine {};

TEST_F(RenderImages, ForeignPicturesAreReadEveryTime) {
  file("a.pse", "color = [u v 0.5]\n");
  ASSERT_EQ(pse({"render", "a.pse", "-o", "a.tif", "--res", "64x64"}).status, 0);
  file("b.pse", "color = 1 - color\n");
  for (int i = 0; i < 8; ++i) {
    const Ended ended = pse({"render", "b.pse", "a.tif", "-o", "b.tif"});
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
}

// A program may draw where its image has nothing: the whole frame is written, unless --clip says
// otherwise (docs/decisions/2026-11-29-windows.md).
TEST_F(RenderImages, ASmallDataWindowDoesNotCutTheOutput) {
  file("make.pse", "color = white\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "in.exr", "--res", "8x6", "--clip", "2,1,5,4"}).status,
            0);
  ASSERT_EQ(picture("in.exr").spec.data, (image::Window{2, 1, 5, 4}));
  file("a.pse", "color = color + [0 0.5 0]\n");
  ASSERT_EQ(pse({"render", "a.pse", "in.exr", "-o", "out.exr", "--layers", "color"}).status, 0);
  const image::Image out = picture("out.exr");
  EXPECT_EQ(out.spec.display, (image::Window{0, 0, 8, 6}));
  EXPECT_EQ(out.spec.data, (image::Window{0, 0, 8, 6}));
  EXPECT_EQ(out.at(out.spec.find("R"), 0, 0), 0);
  EXPECT_EQ(out.at(out.spec.find("G"), 0, 0), 0.5f);
  EXPECT_EQ(out.at(out.spec.find("R"), 3, 2), 1);
  ASSERT_EQ(pse({"render", "a.pse", "in.exr", "-o", "cut.exr", "--clip", "2,1,5,4"}).status, 0);
  EXPECT_EQ(picture("cut.exr").spec.data, (image::Window{2, 1, 5, 4}));
}

// What --colorspace acescg writes is AP1: read as Rec. 709 it is the published matrix's columns
// (Bradford adaptation).
TEST_F(RenderImages, AcescgIsWrittenAsTheKnownMatrixSays) {
  file("a.pse", "Red = 0\nGreen = 0\nBlue = 0\ncolor = [Red Green Blue]\n");
  const char* const names[] = {"Red", "Green", "Blue"};
  const double columns[3][3] = {{1.7050510, -0.1302564, -0.0240034},
                                {-0.6217921, 1.1408048, -0.1289690},
                                {-0.0832589, -0.0105485, 1.1529724}};
  for (int c = 0; c < 3; ++c) {
    ASSERT_EQ(pse({"render", "a.pse", "-o", "a.exr", "--res", "1x1", "--colorspace", "acescg",
                   std::string(names[c]) + "=1"}).status, 0);
    const image::Image read = picture("a.exr");
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(read.at(read.spec.find(std::string(1, "RGB"[k])), 0, 0), columns[c][k], 5e-5);
  }
}

TEST_F(RenderImages, TexturesAreFoundBesideTheProgramAndOnThePath) {
  make_input("in.exr");
  std::filesystem::create_directory(folder() / "assets");
  std::filesystem::rename(folder() / "in.exr", folder() / "assets/wood.exr");
  file("a.pse", "color = texture(\"wood.exr\", u, v, filter=\"nearest\")\n");
  const std::vector<std::string> words = {"render", "a.pse", "-o",     "a.exr",
                                          "--res",  "4x2",   "--float"};
  EXPECT_EQ(pse(words).status, 4);
  environment["PSE_PATH"] = "assets";
  const Ended ended = pse(words);
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(picture("a.exr").at(picture("a.exr").spec.find("R"), 3, 1), 0.875f);
}

TEST_F(RenderImages, AnEnvironmentIsSeenInItsDirections) {
  // A sky whose red grows with longitude and green with latitude; the middle of the picture is +z.
  file("sky.pse", "color = [u v 0]\n");
  ASSERT_EQ(pse({"render", "sky.pse", "-o", "sky.exr", "--res", "64x32", "--float"}).status, 0);
  file("a.pse",
       "d = px < 1 ? [0 0 1] : px < 2 ? [1 0 0] : [0 0.70710678 -0.70710678]\n"
       "color = environment(\"sky.exr\", d)\nblurred = environment(\"sky.exr\", d, 0.1)\n");
  const Ended ended = pse({"render", "a.pse", "-o", "a.exr", "--res", "3x1", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const image::Image seen = picture("a.exr");
  const auto red = [&](int x) { return seen.at(seen.spec.find("R"), x, 0); };
  const auto green = [&](int x) { return seen.at(seen.spec.find("G"), x, 0); };
  EXPECT_NEAR(red(0), 0.5, 0.01);
  EXPECT_NEAR(green(0), 0.5, 0.02);
  EXPECT_NEAR(red(1), 0.75, 0.01);
  EXPECT_NEAR(green(1), 0.5, 0.02);
  EXPECT_NEAR(green(2), 0.75, 0.02);
  EXPECT_NEAR(seen.at(seen.spec.find("blurred.X"), 1, 0), 0.75, 0.02);
}

}  // namespace
}  // namespace pse::test
