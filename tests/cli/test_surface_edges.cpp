// Edges on traced objects that are no edges of a program: where an object hides a part of itself or
// two parts of it meet, where a program's own search ends elsewhere, and where its rays meet
// something else.
#include <cmath>

#include "run_pse.h"

namespace pse::test {
namespace {

class SurfaceEdges : public CommandLine {
 protected:
  std::vector<float> render(std::vector<std::string> arguments, const std::string& antialias) {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"-o", "out.exr", "--float", "--antialias", antialias});
    const Ended ended = pse(arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const image::Image made = picture("out.exr");
    return made.planes[made.spec.find("R")];
  }
  static double distance(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i] - b[i], 2);
    return std::sqrt(sum / static_cast<double>(a.size()));
  }
  // Nearer to many samples than 16 of them.
  void expect_clean(const std::vector<std::string>& arguments) {
    const std::vector<float> truth = render(arguments, "supersample=256");
    const double ours = distance(render(arguments, "procedural"), truth);
    EXPECT_LT(ours, distance(render(arguments, "supersample=16"), truth));
    EXPECT_LT(ours, 0.15 * distance(render(arguments, "none"), truth));
  }
};

// Light from the side, so that what is hidden and what hides it are of different light; no
// conditional tells them apart.
constexpr const char* lit = "color = white * (0.5 + 0.4 * dot(normal, [0.8 0.6 0]))\n";

TEST_F(SurfaceEdges, WhereATorusHidesItself) {
  file("lit.pse", lit);
  expect_clean({"lit.pse", "--on", "torus", "--res", "96x96", "--camera", "eye=0,1.2,3"});
}

// Two walls of one mesh, with normals of their own: no depth jumps.
TEST_F(SurfaceEdges, WherePartsOfAMeshMeet) {
  file("lit.pse", lit);
  file("walls.obj",
       "v -1 -1 0\nv 0.1 -1 0.5\nv 0.3 1 0.5\nv -1 1 0\nv 1 -1 0\nv 1 1 0\n"
       "vn -0.4 0 0.9\nvn 0.5 0 0.8\n"
       "f 1//1 2//1 3//1 4//1\nf 2//2 5//2 6//2 3//2\n");
  expect_clean({"lit.pse", "--on", "walls.obj", "--res", "96x96"});
}

// No edge at all but the outline: what changes within a pixel is sampled on objects too.
TEST_F(SurfaceEdges, NoiseOfAFewPixels) {
  file("noise.pse", "color = white * (0.5 + 0.5 * noise(20 * point))\n");
  expect_clean({"noise.pse", "--on", "torus", "--res", "128x128"});
}

// A loop that searches within a program for objects: its ends are no output.
TEST_F(SurfaceEdges, WhereASearchEndsElsewhere) {
  file("search.pse",
       "p = 3 * point\nt = 0.5 * p.x + 2\nfor i in [1 .. 40]\n"
       "    s = abs(t - (p.y > 0.3 ? 1 : 2)) * 0.5\n    if s < 0.001 break\n    t -= s\n"
       "color = white * t / 3\n");
  expect_clean({"search.pse", "--on", "sphere", "--res", "64x64"});
}

// A ball on a floor. No conditional tells of its shadow, nor of what it mirrors.
constexpr const char* room =
    "program = \"ball.pse\"\nbackground = \"sky.pse\"\n"
    "[camera]\neye = [1.5, 1.6, 6]\ntarget = [0, 0.4, 0]\nfov = 32\n"
    "[[light]]\ndirection = [-0.6, 1, 0.5]\n"
    "[[object]]\nshape = \"plane size=8\"\nprogram = \"floor.pse\"\n"
    "[[object]]\nshape = \"sphere radius=0.6\"\nat = [0.8, 0.6, 0]\n"
    "[[object]]\nshape = \"sphere radius=0.4\"\nat = [-0.6, 0.4, 0.5]\nprogram = \"lit.pse\"\n";

TEST_F(SurfaceEdges, WhereRaysMeetSomethingElse) {
  file("lit.pse", lit);
  file("sky.pse", "color = [0.3 0.3 0.3]\n");
  file("floor.pse", "color = white * (0.3 + 0.6 * visible(place, place + 20 * light_direction))\n");
  file("room.toml", room);
  for (const char* ball :
       {"color = radiance(place, reflect(direction, normal)).rgb\n",
        "h = trace(place, reflect(direction, normal))\ncolor = 0.5 + 0.4 * h.normal\n",
        "h = trace(place, refract(direction, normal, 0.7))\n"
        "color = radiance(h.place, direction).rgb\n"}) {
    file("ball.pse", ball);
    expect_clean({"room.toml", "--res", "96x96"});
  }
}

// Rays into a direction of chance have no edge: each pixel has its own.
TEST_F(SurfaceEdges, WhatRaysOfChanceMeetIsNoEdge) {
  file("lit.pse", lit);
  file("sky.pse", "color = [0.3 0.3 0.3]\n");
  file("floor.pse",
       "d = light_direction + 0.5 * [hash(px, py, 1) 0 hash(px, py, 2)]\n"
       "color = white * visible(place, place + 20 * d)\n");
  file("ball.pse", lit);
  file("room.toml", room);
  const Ended ended = pse({"render", "room.toml", "--res", "96x96", "--stats", "-o", "out.exr"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  // The outlines alone are sampled.
  const std::string said = ended.out + ended.err;
  const std::size_t at = said.find("blended, ");
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_LT(std::stoi(said.substr(at + 9)), 96 * 96 / 12) << said;
}

}  // namespace
}  // namespace pse::test
