// A picture with the names of Blender's passes is shaded as surfaces are: no mapping is needed.
#include <cmath>

#include "image/writer.h"
#include "run_pse.h"

namespace pse::test {
namespace {

class Blender : public CommandLine {
 protected:
  // 4 x 4 pixels as Blender 3.4 writes them, of a mesh without UVs; the left half shows nothing.
  void make_passes() {
    image::ImageSpec spec;
    spec.display = spec.data = {0, 0, 4, 4};
    const char* const names[] = {
        "ViewLayer.Combined.A", "ViewLayer.Combined.B", "ViewLayer.Combined.G",
        "ViewLayer.Combined.R", "ViewLayer.Depth.Z",    "ViewLayer.IndexOB.X",
        "ViewLayer.Normal.X",   "ViewLayer.Normal.Y",   "ViewLayer.Normal.Z",
        "ViewLayer.Position.X", "ViewLayer.Position.Y", "ViewLayer.Position.Z",
        "ViewLayer.UV.A",       "ViewLayer.UV.U",       "ViewLayer.UV.V"};
    for (const char* name : names) spec.channels.push_back({name, image::PixelType::float32});
    image::Image passes(spec);
    const auto plane = [&](const char* name) -> std::vector<float>& {
      return passes.planes[static_cast<std::size_t>(passes.spec.find(name))];
    };
    for (std::size_t i = 0; i < 16; ++i) {
      const bool seen = i % 4 >= 2;
      const float x = static_cast<float>(i % 4), y = static_cast<float>(i / 4);
      plane("ViewLayer.Depth.Z")[i] = seen ? 3 : 1e10f;
      if (!seen) continue;
      plane("ViewLayer.Combined.A")[i] = 1;
      plane("ViewLayer.IndexOB.X")[i] = 2;
      plane("ViewLayer.Normal.Y")[i] = 1;
      plane("ViewLayer.Position.X")[i] = x;
      plane("ViewLayer.Position.Y")[i] = y;
      plane("ViewLayer.Position.Z")[i] = 0.5f;
    }
    ASSERT_TRUE(image::write_image((folder() / "blender.exr").string(), passes));
  }
};

TEST_F(Blender, PassesAreSurfaces) {
  make_passes();
  file("a.pse",
       "Gain = 1\nheat = Gain * point.x + 10 * point.y + 100 * normal.y\nwhose = id\nfar = depth\n"
       "look = view\n");
  const auto run = [&](const std::string& gain) {
    return pse({"render", "a.pse", "blender.exr", "--camera", "eye=3,3,4.5", "-o", "a.exr",
                "--float", "Gain=" + gain});
  };
  Ended ended = run("1");
  ASSERT_EQ(ended.status, 0) << ended.err;
  image::Image made = picture("a.exr");
  const auto at = [&](const char* channel, int x, int y) {
    return made.at(made.spec.find(channel), x, y);
  };
  EXPECT_EQ(at("heat.Y", 3, 2), 123);
  EXPECT_EQ(at("whose.Y", 3, 2), 2);
  EXPECT_EQ(at("far.Y", 3, 2), 3);
  // From the place to the eye: [3 2 0.5] to [3 3 4.5].
  EXPECT_NEAR(at("look.Y", 3, 2), 1 / std::sqrt(17.0), 1e-6);
  EXPECT_NEAR(at("look.Z", 3, 2), 4 / std::sqrt(17.0), 1e-6);
  // Nothing is there to be shaded.
  EXPECT_EQ(at("heat.Y", 1, 2), 0);
  // A knob is moved: the same picture, shaded anew.
  ASSERT_EQ(run("2").status, 0);
  made = picture("a.exr");
  EXPECT_EQ(at("heat.Y", 3, 2), 126);
}

}  // namespace
}  // namespace pse::test
