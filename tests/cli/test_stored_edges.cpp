// Edges of programs that read pictures: a ramp stored in an EXR and cut, and a traced torus shaded
// again.
#include <cmath>

#include "run_pse.h"

namespace pse::test {
namespace {

class StoredEdges : public CommandLine {
 protected:
  image::Image render(std::vector<std::string> arguments, const std::string& name) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"-o", name, "--float"});
    const Ended ended = pse(arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    said_ = ended.out;
    return picture(name);
  }
  static float at(const image::Image& picture, const char* channel, int x, int y) {
    return picture.at(picture.spec.find(channel), x, y);
  }
  std::string said_;
};

TEST_F(StoredEdges, ARampInAFileIsCutCleanly) {
  // A half-plane at atan(0.75), 0.3 pixels beyond the middle of 32 x 32 pixels.
  file("ramp.pse",
       "_x = u * 32\n_y = (1 - v) * 32\n"
       "ramp = 0.5 + 0.1 * (0.8 * (_x - 16) + 0.6 * (_y - 16) - 0.3)\n");
  render({"ramp.pse", "--res", "32x32", "--antialias", "none"}, "ramp.exr");
  file("cut.pse", "if m.ramp > 0.5\n    c = 1\nelse\n    c = 0\n");
  const image::Image cut = render({"cut.pse", "m=ramp.exr", "--stats=json"}, "cut.exr");
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double d = 0.8 * (x - 15.5) + 0.6 * (y - 15.5) - 0.3, t = std::clamp(d + 0.5, 0.0, 1.0);
      EXPECT_NEAR(at(cut, "c.Y", x, y), t * t * (3 - 2 * t), 0.5 / 255) << x << " " << y;
    }
  EXPECT_TRUE(contains(said_, "\"left\": 0"));
}

// What is kept from frame to frame is of the frame's own file.
TEST_F(StoredEdges, EachFrameReadsItsOwnFile) {
  for (const auto& [frame, shape] : {std::pair{"1", "sphere"}, {"2", "torus"}, {"3", "sphere"}})
    ASSERT_EQ(
        pse({"trace", shape, "-o", std::string("g.") + frame + ".exr", "--res", "32x32"}).status,
        0);
  file("show.pse", "color = point + frame\n");
  const auto several = [&](const std::string& input) {
    const Ended ended =
        pse({"render", "show.pse", input, "--frames", "1-3", "-o", "out.%d.exr", "--float"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    return std::array{picture("out.1.exr"), picture("out.2.exr"), picture("out.3.exr")};
  };
  const auto changing = several("g.%d.exr"), same = several("g.1.exr");
  EXPECT_EQ(changing[0].planes, same[0].planes);
  EXPECT_NE(changing[1].planes, same[1].planes);
  EXPECT_EQ(changing[2].planes, same[2].planes);
  EXPECT_NE(same[0].planes, same[2].planes);
}

TEST_F(StoredEdges, ACheckeredTorusShadedAgainIsNearTheTracedOne) {
  file("checks.pse",
       "k = mod(floor(4 * point.x) + floor(4 * point.y + 0.5) + floor(4 * point.z), 2)\n"
       "color = white * k\n");
  ASSERT_EQ(pse({"trace", "torus", "-o", "g.exr", "--res", "128x128"}).status, 0);
  const image::Image traced = render({"checks.pse", "--on", "torus", "--res", "128x128"}, "a.exr");
  const image::Image plain =
      render({"checks.pse", "--on", "torus", "--res", "128x128", "--antialias", "none"}, "b.exr");
  const image::Image stored = render({"checks.pse", "g.exr"}, "c.exr");
  const image::Image g = picture("g.exr");
  // Inside of the outline, where the traced picture has its edges as well.
  double ours = 0, none = 0;
  for (int y = 1; y < 127; ++y)
    for (int x = 1; x < 127; ++x) {
      bool inside = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) inside = inside && at(g, "id.Y", x + dx, y + dy) > 0;
      if (!inside) continue;
      ours += std::pow(at(stored, "R", x, y) - at(traced, "R", x, y), 2);
      none += std::pow(at(plain, "R", x, y) - at(traced, "R", x, y), 2);
    }
  EXPECT_GT(none, 10);
  // Where the torus hides a part of itself, pixels of one object are neighbours that lie apart.
  EXPECT_LT(ours, 0.15 * none);
}

}  // namespace
}  // namespace pse::test
