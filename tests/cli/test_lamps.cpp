// Soft shadows of the library (library/lamps.pse) in scenes where the part of a lamp that is seen is
// known: nothing, everything, and the half beyond a straight edge.
#include "run_pse.h"

namespace pse::test {
namespace {

class Lamps : public CommandLine {
 protected:
  // What a program sees on the floor, y = 0, at the middle of the picture, under `objects`.
  float seen(const std::string& program, const std::string& objects) {
    file("floor.pse", "color = white * " + program + "\n");
    file("scene.toml",
         "[camera]\neye = [0, 1, 0.2]\ntarget = [0, 0, 0]\n[[object]]\nshape = \"plane\"\n" + objects);
    const Ended ended = pse({"render", "floor.pse", "--scene", "scene.toml", "-o", "a.exr", "--res",
                             "101x101", "--clip", "50,50,51,51", "--float"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    if (ended.status != 0) return -1;
    const image::Image image = picture("a.exr");
    return image.at(image.spec.find("R"), 50, 50);
  }
  // A slab 2 metres up whose edge stands right above the middle, and one all over it.
  const std::string half_ = "[[object]]\nshape = \"box\"\nsize = [40, 0.01, 40]\nat = [20, 2, 0]\n";
  const std::string roof_ = "[[object]]\nshape = \"box\"\nsize = [400, 0.01, 400]\nat = [0, 2, 0]\n";
};

TEST_F(Lamps, AFarLampIsSeenWhereNothingStandsBetween) {
  const std::string lamp = "far_lamp(place, normal, [0 1 0], 0.3, 256)";
  EXPECT_EQ(seen(lamp, ""), 1.0f);
  EXPECT_EQ(seen(lamp, roof_), 0.0f);
  EXPECT_NEAR(seen(lamp, half_), 0.5f, 0.02f);
}

TEST_F(Lamps, AFarLampIsAsWideAsItsSize) {
  // The lamp of sine 0.3 covers a disc of radius 0.6 at the slab's height, and the slab all of it
  // beyond half a radius from its middle: the segment (PI / 3 - sqrt(3) / 4) / PI.
  const std::string slab = "[[object]]\nshape = \"box\"\nsize = [40, 0.01, 40]\nat = [20.3, 2, 0]\n";
  EXPECT_NEAR(seen("far_lamp(place, normal, [0 1 0], 0.3, 512)", slab), 1 - 0.1955f, 0.01f);
}

TEST_F(Lamps, ALampBehindTheFloorIsNotSeen) {
  EXPECT_EQ(seen("far_lamp(place, normal, [0 -1 0], 0.1, 16)", ""), 0.0f);
}

TEST_F(Lamps, ANearLampCastsAShadowOnlyFromWhatIsBeforeIt) {
  const std::string lamp = "near_lamp(place, normal, [0 3 0], 0.4, 256)";
  EXPECT_EQ(seen(lamp, ""), 1.0f);
  EXPECT_EQ(seen(lamp, roof_), 0.0f);
  EXPECT_NEAR(seen(lamp, half_), 0.5f, 0.02f);
  EXPECT_EQ(seen("near_lamp(place, normal, [0 1 0], 0.4, 64)", roof_), 1.0f);
}

TEST_F(Lamps, TheSkyIsHalfOpenBesideAWall) {
  // A wall hard by hides one half of the directions, however they are weighed.
  const std::string wall =
      "[[object]]\nshape = \"box\"\nsize = [0.1, 40, 40]\nat = [0.07, 0, 0]\n";
  EXPECT_EQ(seen("open_sky(place, normal, 5, 64)", ""), 1.0f);
  EXPECT_NEAR(seen("open_sky(place, normal, 10, 512)", wall), 0.5f, 0.02f);
  // Only what is within reach counts.
  EXPECT_EQ(seen("open_sky(place, normal, 1, 64)", roof_), 1.0f);
}

TEST_F(Lamps, WhatIsOfTheObjectTurnsWithIt) {
  // A ball turned by 90 degrees about z: its own x axis points up, its y axis to the left.
  file("ball.pse", "color = in_world([1 0.5 0])\n");
  file("scene.toml", "[camera]\neye = [0, 0, 5]\n[[object]]\nshape = \"sphere\"\nturn = [0, 0, 90]\n");
  const Ended ended = pse({"render", "ball.pse", "--scene", "scene.toml", "-o", "a.exr", "--res",
                           "9x9", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const image::Image image = picture("a.exr");
  const float want[] = {-0.5f, 1, 0};
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(image.at(image.spec.find(std::string(1, "RGB"[c])), 4, 4), want[c], 1e-6) << c;
}

}  // namespace
}  // namespace pse::test
