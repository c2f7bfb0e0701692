// `--display` and `--view`: our own curves, and views of a small OpenColorIO configuration.
#include "run_pse.h"

namespace pse::test {
namespace {

// Two displays: `screen` halves the light or quarters it, `cinema / beamer` takes an eighth.
class Display : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    const auto space = [](const std::string& name, const std::string& k) {
      return "  - !<ColorSpace>\n    name: " + name +
             "\n    from_reference: !<MatrixTransform> {matrix: [" + k + ", 0, 0, 0, 0, " + k +
             ", 0, 0, 0, 0, " + k + ", 0, 0, 0, 0, 1]}\n";
    };
    file("config.ocio",
         "ocio_profile_version: 1\nroles:\n  scene_linear: lin\n  default: lin\ndisplays:\n"
         "  screen:\n    - !<View> {name: half, colorspace: half}\n"
         "    - !<View> {name: a quarter, colorspace: quarter}\n"
         "  cinema / beamer:\n    - !<View> {name: eighth, colorspace: eighth}\n"
         "active_displays: [screen, cinema / beamer]\ncolorspaces:\n"
         "  - !<ColorSpace>\n    name: lin\n" +
             space("half", "0.5") + space("quarter", "0.25") + space("eighth", "0.125"));
    file("a.pse", "color = [0.8 0.4 0]\nalpha = 1\n");
    environment["OCIO"] = "config.ocio";
  }

  // Renders to a PNG and gives red as a share of 255, or skips where OpenColorIO is missing.
  int red(const std::vector<std::string>& options, const std::string& name = "a.png") {
    std::vector<std::string> words = {"render", "a.pse", "-o", name, "--res", "2x2"};
    words.insert(words.end(), options.begin(), options.end());
    last = pse(words);
    if (last.status != 0) return -last.status;
    image::ReadOptions stored;
    stored.working.reset();
    const auto read = image::read_image((folder() / name).string(), stored);
    return static_cast<int>(read->at(read->spec.find("R"), 0, 0) * 255.0f + 0.5f);
  }
  Ended last;
};

#define NEEDS_OCIO()                                                              \
  if (red({"--display", "ocio"}); last.err.find("pse_ocio") != std::string::npos) \
  GTEST_SKIP() << "without OpenColorIO"

TEST_F(Display, ViewsByName) {
  NEEDS_OCIO();
  // 0.8 * 255 = 204; dithering moves what lies between two steps, and these do not.
  EXPECT_EQ(red({"--display", "ocio"}), 102) << last.err;
  EXPECT_EQ(red({"--display", "screen"}), 102);
  EXPECT_EQ(red({"--display", "screen", "--view", "a quarter"}), 51);
  EXPECT_EQ(red({"--view", "a quarter"}), 51);
  EXPECT_NEAR(red({"--display", "cinema / beamer"}), 25.5, 0.6);
  // The variable alone changes nothing, and neither does it for our own curves.
  EXPECT_EQ(red({}), red({"--display", "srgb"}));
  EXPECT_EQ(red({"--display", "none"}), 204);
}

TEST_F(Display, WhatThereIsIsListed) {
  NEEDS_OCIO();
  EXPECT_EQ(red({"--display", "tv"}), -2);
  for (const char* part : {"no display `tv`", "screen, cinema / beamer"})
    EXPECT_TRUE(contains(last.err, part));
  EXPECT_EQ(red({"--display", "screen", "--view", "third"}), -2);
  for (const char* part : {"`screen`", "no view `third`", "half, a quarter"})
    EXPECT_TRUE(contains(last.err, part));
  EXPECT_EQ(red({"--display", "srgb", "--view", "half"}), -2);
  EXPECT_FALSE(exists("never.png"));
}

TEST_F(Display, WithoutAConfiguration) {
  NEEDS_OCIO();
  environment["OCIO"] = "missing.ocio";
  EXPECT_EQ(red({"--display", "screen"}), -4) << last.err;
  EXPECT_TRUE(contains(last.err, "missing.ocio"));
  file("broken.ocio", "this: [is\nno configuration");
  environment["OCIO"] = "broken.ocio";
  EXPECT_EQ(red({"--display", "screen"}), -4) << last.err;
  environment.erase("OCIO");
  EXPECT_EQ(red({"--display", "screen"}), -2);
  EXPECT_TRUE(contains(last.err, "srgb, filmic or none"));
  EXPECT_EQ(red({"--display", "ocio"}), -2);
  EXPECT_TRUE(contains(last.err, "OCIO"));
  EXPECT_GT(red({"--display", "filmic"}), 0);
}

TEST_F(Display, ResumeKnowsTheView) {
  NEEDS_OCIO();
  EXPECT_EQ(red({"--display", "screen", "--resume"}), 102);
  EXPECT_EQ(red({"--display", "screen", "--resume"}), 102);
  EXPECT_TRUE(contains(last.err, "kept"));
  EXPECT_EQ(red({"--view", "a quarter", "--resume"}), 51);
  EXPECT_TRUE(contains(last.err, "wrote"));
}

TEST_F(Display, DataAndLightAreNotTouched) {
  NEEDS_OCIO();
  file("b.pse", "heat = 0.8\n");
  ASSERT_EQ(
      pse({"render", "b.pse", "-o", "heat=b.png", "--display", "screen", "--res", "2x2"}).status,
      0);
  ASSERT_EQ(
      pse({"render", "a.pse", "-o", "a.exr", "--display", "screen", "--res", "2x2", "--float"})
          .status,
      0);
  EXPECT_EQ(picture("a.exr").at(picture("a.exr").spec.find("R"), 0, 0), 0.8f);
  image::ReadOptions stored;
  stored.working.reset();
  EXPECT_EQ(image::read_image((folder() / "b.png").string(), stored)->planes[0][0], 0.8f);
}

}  // namespace
}  // namespace pse::test
