// The prepass: the same picture from fewer steps, thin matter is found or told of; and slices.
#include <algorithm>
#include <cmath>

#include "run_pse.h"

namespace pse::test {
namespace {

class Prepass : public CommandLine {
 protected:
  // A picture of a density, with and without prepass; evaluations counts what marching took.
  void program(const std::string& density) {
    file("a.pse",
         "function density(p)\n" + density +
             "function light(p, d)\n    return [1 0.5 p.z]\n"
             "origin = [0.5 * x, 0.5 * y, 2]\n"
             "span = raymarch_interval(density, origin, [0 0 -1], 1.5, 2.5, 1 / height)\n"
             "evaluations = raymarch_count(density, origin, [0 0 -1], 1.5, 2.5, 1 / height)\n"
             "color = raymarch(density, light, origin, [0 0 -1], 1.5, 2.5, 1 / height)\n");
  }
  image::Image render(const std::vector<std::string>& options, const std::string& what = "color") {
    std::vector<std::string> words = {"render",  "a.pse",   "-o",          what + "=a.exr", "--res",
                                      "128x128", "--float", "--antialias", "none"};
    words.insert(words.end(), options.begin(), options.end());
    ended = pse(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return picture("a.exr");
  }
  static double sum(const image::Image& image) {
    double total = 0;
    for (const float value : image.planes[0]) total += double(value);
    return total;
  }
  Ended ended;
};

TEST_F(Prepass, GivesTheSamePictureFromFewerSteps) {
  program("    return clamp(8 * (0.12 - length(p - [0.1 0.2 0])), 0, 1)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  EXPECT_EQ(whole.planes, fast.planes);  // bit for bit: the same steps of the same rays
  EXPECT_FALSE(contains(ended.err, "warning"));
  double light = 0;
  for (const float value : whole.planes[0]) light += double(value);
  EXPECT_GT(light, 100);
  const double all = sum(render({}, "evaluations")),
               few = sum(render({"--prepass", "4"}, "evaluations"));
  EXPECT_NEAR(all, 128.0 * 128 * 128, 128.0 * 128 * 10);
  EXPECT_LT(few, all / 20);
}

TEST_F(Prepass, FollowsAHairThinnerThanItsStep) {
  // A wire of 1.5 pixels from corner to corner: of 4 x 4 x 4 samples most see nothing.
  program(
      "    a = [-0.45 -0.4 -0.3]\n    b = [0.4 0.45 0.35]\n"
      "    t = clamp(dot(p - a, b - a) / dot(b - a, b - a), 0, 1)\n"
      "    return length(p - a - t * (b - a)) < 0.75 / height ? 0.9 : 0\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  int there = 0, missing = 0;
  for (std::size_t i = 0; i < whole.planes[0].size(); ++i) {
    there += whole.planes[0][i] > 0 ? 1 : 0;
    missing += whole.planes[0][i] != fast.planes[0][i] ? 1 : 0;
  }
  EXPECT_GT(there, 80);
  EXPECT_EQ(missing, 0);
}

TEST_F(Prepass, ProvesTheRestEmptySoThatNothingThinIsLost) {
  // Five crumbs of a pixel and a half, far apart: smaller than every coarse step and beside most
  // probes.
  program(
      "    d = 0\n    for i in [1 .. 5]\n"
      "        c = [0.37 * sin(2.1 * i) 0.41 * cos(1.7 * i) 0.3 * sin(i)]\n"
      "        d = max(d, norm(p - c) < 1.1 / height ? 0.9 : 0)\n    return d\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4", "--stats"});
  EXPECT_TRUE(contains(ended.err, "nothing is missed")) << ended.err;
  EXPECT_FALSE(contains(ended.err, "warning")) << ended.err;
  EXPECT_EQ(whole.planes, fast.planes);
  EXPECT_GT(std::ranges::count_if(whole.planes[0], [](float v) { return v > 0; }), 5);
}

TEST_F(Prepass, HypertextureAloneSaysWhereItsMatterIs) {
  file("a.pse",
       "function density(p)\n    return soft_sphere(p, 0.5, 0.1)\n"
       "color = hypertexture(density, step = 0.03)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  double apart = 0;
  for (std::size_t k = 0; k < whole.planes.size(); ++k)
    for (std::size_t i = 0; i < whole.planes[k].size(); ++i)
      apart = std::max(apart, std::abs(double(whole.planes[k][i]) - double(fast.planes[k][i])));
  EXPECT_LT(apart, 0.005);
}

// Rays of the middle column and row run along sides of the box, where a place of entry has no
// bounds.
TEST_F(Prepass, AHairInTheStudioIsWhole) {
  file("a.pse",
       "function density(p)\n"
       "    return norm([p.x - 0.1 * sin(4 * p.y), p.z]) < 0.01 and abs(p.y) < 1 ? 1 : 0\n"
       "color = hypertexture(density)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4", "--stats"});
  EXPECT_TRUE(contains(ended.err, "nothing is missed")) << ended.err;
  EXPECT_EQ(whole.planes, fast.planes);
}

// A hair before a body is no thinner in its cells than what lies behind it, and yet nearer.
TEST_F(Prepass, FollowsAHairBeforeABody) {
  file("a.pse",
       "function density(p)\n"
       "    hair = norm([p.x - 0.1 * sin(4 * p.y), p.z - 1.2]) < 0.012 and abs(p.y) < 1\n"
       "    return max(soft_sphere(p, 0.9, 0.05), hair ? 1 : 0)\n"
       "color = hypertexture(density, shadows = 0, crevices = 0)\n");
  EXPECT_EQ(render({}).planes, render({"--prepass", "4"}).planes);
}

// Matter that the box cuts off, where only some rays of a pixel meet the box.
TEST_F(Prepass, MatterUpToTheEdgeOfTheBoxIsWhole) {
  file("a.pse",
       "function density(p)\n    return 3 * Noise(4 * p)\n"
       "color = hypertexture(density, step = 0.03, shadows = 0, crevices = 0)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  EXPECT_EQ(whole.planes, fast.planes);
}

// A pebble that runs around a ring while the shutter is open: bounds cannot say where it is not,
// and at one moment a ray sees nothing of most of its way.
TEST_F(Prepass, WhatMovesIsLookedForAllThroughTheShutter) {
  file("a.pse",
       "function moment(origin, dir, chance)\n    return chance\n"
       "function density(p, t)\n"
       "    return norm(p - [0.9 * sin(6 * t), 0.9 * cos(6 * t), 0]) < 0.06 ? 1 : 0\n"
       "function light(d)\n    return [1 1 1]\n"
       "color = hypertexture(density, light, luminous, moment, step = 0.02, shaded = false,\n"
       "    shadows = 0)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  file("a.pse",
       "color = hypertexture(nothing, shaded = false, shadows = 0)\n"
       "function nothing(p)\n    return 0\n");
  const image::Image backdrop = render({});
  int there = 0, missing = 0;
  for (std::size_t i = 0; i < whole.planes[0].size(); ++i) {
    there += whole.planes[0][i] != backdrop.planes[0][i] ? 1 : 0;
    missing += whole.planes[0][i] != fast.planes[0][i] ? 1 : 0;
  }
  EXPECT_GT(there, 50);
  EXPECT_EQ(missing, 0);
}

TEST_F(Prepass, ASpanOfTheProgramsOwnMakingIsNoDensity) {
  file("a.pse",
       "function density(p)\n    return soft_sphere(p, 0.5, 0.1)\n"
       "function light(p, d)\n    return white * p.z\n"
       "origin = [x y 2]\nspan = sphere_span(origin, [0 0 -1], 0.7)\n"
       "color = raymarch(density, light, origin, [0 0 -1], span.x, span.y, 0.02, 20)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "4"});
  EXPECT_EQ(whole.planes, fast.planes);
}

TEST_F(Prepass, TellsOfSpecksThatItDidNotSeeAtFirst) {
  // Motes of a third of a pixel's size, few and far apart: no search sees them all.
  program(
      "    c = floor(16 * p)\n"
      "    return hash(c.x, c.y, c.z) < 0.1 and length(fract(16 * p) - 0.5) < 0.12 ? 0.9 : 0\n");
  const image::Image whole = render({"--res", "192x192"}),
                     fast = render({"--res", "192x192", "--prepass", "8"});
  EXPECT_TRUE(contains(ended.err, "the prepass did not see all matter at first")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "thinner than 8 pixels or steps")) << ended.err;
  EXPECT_EQ(whole.planes, fast.planes);
}

// Turbulence has tips of any size just outside of what is found, whose bounds prove little.
TEST_F(Prepass, ABallOfTurbulenceIsWhole) {
  for (const std::string step : {"0.02", "0.05"})
    for (const std::string size : {"64x64", "96x96", "192x192"})
      for (const std::string how : {"none", "procedural"}) {
        if (size == "192x192" && how != "none") continue;
        file("a.pse",
             "function density(p)\n"
             "    return saturate(3 * (0.7 - norm(p) + 0.4 * turbulence(2 * p)))\n"
             "function light(p, d)\n    return [1 0.5 p.z]\n"
             "color = raymarch(density, light, [x y 2], [0.1 0 -1], 0.5, 3.5, " +
                 step + ")\n");
        const std::vector<std::string> options = {"--res", size, "--antialias", how};
        std::vector<std::string> with = options;
        with.insert(with.end(), {"--prepass", "4"});
        EXPECT_EQ(render(options).planes, render(with).planes) << step << " " << size << how;
        EXPECT_FALSE(contains(ended.err, "warning")) << ended.err;
      }
}

// Where most is neither found nor proven and too much to march, samples are all there is: of what
// they lose the prepass says that it may.
TEST_F(Prepass, TellsWhereItTookOnlySamples) {
  file("a.pse",
       "function density(p)\n    return norm(p) < 0.1 + 0.3 * turbulence(5 * p) ? 1 : 0\n"
       "function light(p, d)\n    return [1 0.5 p.z]\n"
       "color = raymarch(density, light, [x y 2], [0.1 0 -1], 0.5, 3.5, 0.02)\n");
  const image::Image whole = render({"--res", "320x320"}),
                     fast = render({"--res", "320x320", "--prepass", "4"});
  int lost = 0;
  for (std::size_t i = 0; i < whole.planes[0].size(); ++i)
    lost += whole.planes[0][i] != fast.planes[0][i] ? 1 : 0;
  EXPECT_LT(lost, 100);
  EXPECT_TRUE(contains(ended.err, "warning: the prepass took samples only of ")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "specks thinner than 4 pixels or steps may be missing there"));
  // A picture so small that nothing is gained is marched whole.
  EXPECT_EQ(render({"--res", "128x128"}).planes,
            render({"--res", "128x128", "--prepass", "4"}).planes);
  EXPECT_FALSE(contains(ended.err, "samples only")) << ended.err;
}

// However many samples of smoke met nothing new, they prove nothing of what lies between.
TEST_F(Prepass, SaysOfSmokeThatItTookOnlySamples) {
  const std::string smoke = PSE_SOURCE_DIR "/gallery/2002/hypertexture/smoke.pse";
  ended = pse({"render", smoke, "-o", "s.png", "--res", "512x512", "--antialias", "none",
               "--prepass", "4"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "warning: the prepass took samples only of 10 % ")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "may be missing there (of 3591 later samples")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "Without --prepass none is")) << ended.err;
  ended = pse({"render", smoke, "-o", "s.png", "--res", "512x512", "--antialias", "none",
               "--prepass", "4", "-Wno-prepass"});
  EXPECT_FALSE(contains(ended.err, "samples")) << ended.err;
}

// A span that takes no steps is asked for in every pixel: nothing lies between.
TEST_F(Prepass, ASpanOfTheProgramsOwnMakingIsAskedForInEveryPixel) {
  file("a.pse",
       "function density(p)\n    return 0.5\nfunction light(p, d)\n    return white\n"
       "block = px > 20 and px < 120 and py > 20 and py < 120\n"
       "speck = floor(px) % 64 == 35 and floor(py) % 128 == 10\n"
       "span = block or speck ? [1 1.2] : [1 0]\n"
       "color = raymarch(density, light, [x y 2], [0 0 -1], span.x, span.y, 0.02, 20)\n");
  const image::Image whole = render({"--res", "256x256"}),
                     fast = render({"--res", "256x256", "--prepass", "8"});
  EXPECT_GT(whole.at(0, 99, 138), 0);  // a speck
  EXPECT_EQ(whole.planes, fast.planes);
  EXPECT_FALSE(contains(ended.err, "samples only")) << ended.err;
}

TEST_F(Prepass, ProvesWhatIsLeftBesideABody) {
  // The body is too large for a proof alone, and four specks of a pixel are beside all samples.
  file("a.pse",
       "function density(p)\n    d = soft_sphere(p + [0.5 0 0], 0.5, 0.05)\n"
       "    for i in [1 .. 4]\n"
       "        c = [0.5 + 0.7 * sin(2.1 * i) 0.9 * cos(1.7 * i) 0.8 * sin(i)]\n"
       "        d = max(d, norm(p - c) < 0.012 ? 1 : 0)\n    return d\n"
       "color = hypertexture(density, step = 0.02, shadows = 0, crevices = 0)\n");
  const image::Image whole = render({}), fast = render({"--prepass", "8", "--stats"});
  EXPECT_TRUE(contains(ended.err, "nothing is missed")) << ended.err;
  EXPECT_EQ(whole.planes, fast.planes);
}

// What lies between samples, by its nature: thin, small, sharp, at the border, or moving.
struct Opponent {
  const char *name, *text;
  const char* res = "96x96";
};
class PrepassAgainst : public Prepass, public ::testing::WithParamInterface<Opponent> {};

TEST_P(PrepassAgainst, GivesTheSamePicture) {
  file("a.pse", std::string(GetParam().text) +
                    "color = hypertexture(density, init_density = moment, step = 0.02,\n"
                    "    shadows = 0, crevices = 0)\n"
                    "function moment(origin, dir, chance)\n    return chance\n");
  const image::Image whole = render({"--res", GetParam().res});
  EXPECT_EQ(whole.planes, render({"--res", GetParam().res, "--prepass", "4"}).planes) << ended.err;
}

// Antialiasing looks between pixels and beyond the picture, and takes no end of a span for an edge.
TEST_P(PrepassAgainst, GivesTheSamePictureWithCleanEdges) {
  file("a.pse", std::string(GetParam().text) +
                    "color = hypertexture(density, init_density = moment, step = 0.02,\n"
                    "    shadows = 0, crevices = 0)\n"
                    "function moment(origin, dir, chance)\n    return chance\n");
  for (const std::string how : {"procedural", "supersample=4"}) {
    const std::vector<std::string> options = {"--res", "48x48", "--antialias", how};
    std::vector<std::string> with = options;
    with.insert(with.end(), {"--prepass", "4"});
    EXPECT_EQ(render(options).planes, render(with).planes) << how << ended.err;
  }
}

// Marches without chance are decisions of their own, in loops that end where the span does.
TEST_F(Prepass, TheEndOfASpanIsNoEdge) {
  struct Scene {
    const char *matter, *direction, *size;
  };
  for (const auto& [matter, direction, size] :
       {Scene{"abs(dot(sin(5 * p), cos(5 * [p.y p.z p.x]))) < 0.06 and norm(p) < 1.3 ? 1 : 0",
              "[0 0 -1]", "64x64"},
        Scene{"p.x * p.x + p.z * p.z < 0.04 + 0.03 * turbulence(3 * p) ? 0.3 : 0", "[0 0 -1]",
              "64x64"},
        // Told from edges by what the march's last turn changes alone.
        Scene{"saturate(1.5 - 6 * abs(dot(sin(9 * p), cos(9 * [p.y p.z p.x])))) * "
              "saturate(20 - 20 * norm(p))",
              "[0.1 0 -1]", "96x96"}}) {
    file("a.pse", std::string("function density(p)\n    return ") + matter +
                      "\nfunction light(p, d)\n    return [1 0.5 p.z]\n" +
                      "color = raymarch(density, light, [x y 2], " + direction +
                      ", 0.5, 3.5, 0.02)\n");
    const std::vector<std::string> options = {"--res", size, "--antialias", "procedural"};
    const image::Image whole = render(options),
                       fast =
                           render({"--res", size, "--antialias", "procedural", "--prepass", "4"});
    EXPECT_EQ(whole.planes, fast.planes) << matter;
    EXPECT_NE(whole.planes, render({"--res", size}).planes);
  }
}

constexpr Opponent opponents[] = {
    {"ThinWalls",
     "function density(p)\n    g = dot(sin(5 * p), cos(5 * [p.y p.z p.x]))\n"
     "    return abs(g) < 0.06 and norm(p) < 1.3 ? 1 : 0\n"},
    {"Hairs",
     "function density(p)\n"
     "    a = norm([p.x - 0.3 * sin(3 * p.y), p.z - 0.3 * cos(5 * p.y)]) < 0.006\n"
     "    b = norm([p.y - 0.5 * sin(2 * p.x), p.z + 0.4 * cos(3 * p.x)]) < 0.006\n"
     "    return (a or b) and norm(p) < 1.3 ? 1 : 0\n"},
    {"Dust",
     "function density(p)\n    c = floor(4 * p)\n"
     "    o = 0.3 + 0.4 * [hash(c.x, c.y, c.z, 1) hash(c.x, c.y, c.z, 2) hash(c.x, c.y, c.z, 3)]\n"
     "    return norm(4 * p - c - o) < 0.06 and norm(p) < 1.3 ? 1 : 0\n"},
    {"SheetsAtTheBordersOfTheBox",
     "function density(p)\n    sheet = abs(p.z - 1.44) < 0.005 and p.x < 0\n"
     "    return p.y < -1.42 or p.x > 1.43 or sheet ? 1 : 0\n"},
    {"SharpNoise",
     "function density(p)\n    return Noise(9 * p) > 0.45 and norm(p) < 1.2 ? 1 : 0\n", "128x128"},
    {"Below0Outside",
     "function density(p)\n    d = 30 * (0.02 - abs(norm(p) - 0.8))\n"
     "    return d - (p.x > 0.2 ? 100 : 0)\n"},
    {"ABlade",
     "function density(p, t)\n"
     "    c = [1.1 * sin(5 * t + 2 * p.z), 0.8 * cos(4 * t)]\n"
     "    return norm([p.x - c.x, p.y - c.y]) < 0.03 and abs(p.z) < 1 ? 1 : 0\n"}};

// The same searched for, in pictures of which the bounds leave too much to be marched.
TEST_F(Prepass, FindsABladeByItsSamples) {
  file("a.pse", std::string(opponents[6].text) +
                    "color = hypertexture(density, init_density = moment, step = 0.02,\n"
                    "    shadows = 0, crevices = 0)\n"
                    "function moment(origin, dir, chance)\n    return chance\n");
  const image::Image whole = render({"--res", "320x320"}),
                     fast = render({"--res", "320x320", "--prepass", "4"});
  EXPECT_TRUE(contains(ended.err, "samples only of")) << ended.err;
  EXPECT_EQ(whole.planes, fast.planes);
}

INSTANTIATE_TEST_SUITE_P(Prepass, PrepassAgainst, ::testing::ValuesIn(opponents),
                         [](const auto& one) { return one.param.name; });

TEST_F(Prepass, IsAnImageOfNearAndFar) {
  program("    return length(p) < 0.2 ? 0.5 : 0\n");
  render({"--prepass", "4", "--prepass-image", "span.exr"});
  const image::Image span = picture("span.exr");
  const int near = span.spec.find("near.Y"), far = span.spec.find("far.Y");
  ASSERT_GE(near, 0);
  // The middle ray meets the ball from 1.8 to 2.2; the interval is at most three coarse steps
  // longer.
  EXPECT_LE(span.at(near, 64, 64), 1.8f);
  EXPECT_GE(span.at(near, 64, 64), 1.8f - 3 * 4.0f / 128);
  EXPECT_GE(span.at(far, 64, 64), 2.2f);
  EXPECT_GT(span.at(near, 3, 3), span.at(far, 3, 3));  // nothing in the corner
  // The image alone does the same as the option.
  const image::Image again = render({"prepass=span.exr"});
  EXPECT_EQ(again.planes, render({}).planes);
}

TEST_F(Prepass, SeveralFramesWantSeveralImages) {
  program("    return norm(p - [0.3 * time 0 0]) < 0.2 ? 1 : 0\n");
  ended = pse({"render", "a.pse", "-o", "a.%d.exr", "-f", "1-2", "--res", "32x32", "--prepass", "4",
               "--prepass-image", "span.exr"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_TRUE(contains(ended.err, "2 frames would all go to `span.exr`")) << ended.err;
  EXPECT_EQ(pse({"render", "a.pse", "-o", "a.%d.exr", "-f", "1-2", "--res", "32x32", "--prepass",
                 "4", "--prepass-image", "span.%d.exr"})
                .status,
            0);
}

TEST_F(Prepass, NeedsASpan) {
  file("b.pse", "color = [x y 0]\n");
  const Ended refused = pse({"render", "b.pse", "-o", "b.png", "--prepass", "4"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(contains(refused.err, "raymarch_interval"));
  file("c.pse", "span = x\ncolor = [x y 0]\n");
  EXPECT_EQ(pse({"render", "c.pse", "-o", "b.png", "--prepass", "4"}).status, 3);
}

TEST_F(Prepass, SlicesShowTheDensityOnAPlane) {
  file("s.pse", "function density(p)\n    return p.x + 10 * p.y + 100 * p.z\ncolor = [7 7 7]\n");
  const auto slice = [&](const std::string& where, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"render", "s.pse", "-o", "color=s.exr", "--res", "4", "--float",
                               "--antialias", "none", "--slice", where});
    const Ended done = pse(more);
    EXPECT_EQ(done.status, 0) << done.err;
    return picture("s.exr");
  };
  // Pixel (3, 0) is at 0.75 right and 0.75 up.
  EXPECT_FLOAT_EQ(slice("z=0.5").at(0, 3, 0), 0.75f + 7.5f + 50);
  EXPECT_FLOAT_EQ(slice("x=0.5").at(0, 3, 0), 0.5f + 7.5f - 75);  // right is -z
  EXPECT_FLOAT_EQ(slice("y=0.5").at(0, 3, 0), 0.75f + 5 - 75);    // up is -z
  EXPECT_FLOAT_EQ(slice("z=0", {"XFORM=2,0,0,0,2,0"}).at(0, 3, 0), 1.5f + 15);
  EXPECT_EQ(pse({"render", "s.pse", "-o", "s.png", "--slice", "w=1"}).status, 2);
  file("t.pse", "color = [x y 0]\n");
  EXPECT_EQ(pse({"render", "t.pse", "-o", "s.png", "--slice", "z=0"}).status, 2);
}

}  // namespace
}  // namespace pse::test
