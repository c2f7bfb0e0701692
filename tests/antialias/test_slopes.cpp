// What Dx, Dy and filterwidth say, against differences of neighbouring pixels, and that sums of
// noise fade by it without becoming edges.
#include <gtest/gtest.h>

#include <cmath>

#include "picture.h"

namespace pse::antialias::test {
namespace {

// Smooth programs that set `f`, through what carries slopes: functions, branches, loops, arrays.
const std::vector<std::pair<const char*, const char*>> smooth = {
    {"arithmetic", "f = 3 * x * y - x / (2 + y) + sqrt(2 + x)\n"},
    {"functions", "function g(p)\n    return sin(2 * p.x) + exp(p.y)\nf = g([y x])\n"},
    {"branches", "if u > 2\n    f = x\nelse\n    f = x * x * y\n"},
    {"loops", "f = x\nfor i in [1 .. 5]\n    f = f * 0.9 + 0.1 * sin(3 * f + y)\n"},
    {"arrays", "a = array(3)\nfor i in [1 .. 3]\n    a[i] = x * i\nf = a[2] * a[3] + y\n"},
    {"noise", "f = Noise(x, y)\n"},
};

TEST(Slopes, AreTheDifferencesOfNeighbours) {
  for (const auto& [name, text] : smooth) {
    const Picture picture =
        render(std::string(text) + "right = Dx(f)\ndown = Dy(f)\nwide = filterwidth(f)\n",
               {.width = 64, .height = 64, .antialias = plain()});
    for (int y = 1; y < 63; y += 7)
      for (int x = 1; x < 63; x += 7) {
        const float right = (picture.at(x + 1, y, "f") - picture.at(x - 1, y, "f")) / 2;
        const float down = (picture.at(x, y + 1, "f") - picture.at(x, y - 1, "f")) / 2;
        EXPECT_NEAR(picture.at(x, y, "right"), right, 5e-4) << name << x << " " << y;
        EXPECT_NEAR(picture.at(x, y, "down"), down, 5e-4) << name << x << " " << y;
        EXPECT_NEAR(picture.at(x, y, "wide"), std::hypot(right, down), 7e-4) << name;
      }
  }
}

// A loop's head, an early return, slopes of slopes (none), steps (none).
const std::vector<const char*> others = {
    "c = 0\n_f = 1\nwhile _f < 0.5 / filterwidth(3 * x * x + y)\n    c += Noise(_f * x, y) / _f\n  "
    "  _f *= 2\n",
    "function g(p)\n    if p.x < 0\n        return filterwidth(p.x * p.y)\n    return Dx(p.y)\nc = "
    "g([x y])\n",
    "c = Dx(Dx(x * x)) + Dy(floor(7 * y))\n",
    "c = turbulence([x y 0.3] * (1 + x)) + fbm([x * y, y]) + ridges(3 * point) + "
    "one_over_f(point)\n",
};

TEST(Slopes, TheSameBitsEveryWay) {
  for (const char* text : others) {
    const auto with = [&](PictureOptions options) {
      options.width = 40, options.height = 23, options.antialias = plain();
      return render(text, options).planes;
    };
    const auto meant = with({.interpret = true});
    for (const int width : {1, 4, 8}) EXPECT_EQ(with({.vector_width = width}), meant) << text;
    EXPECT_EQ(with({.tile = 8, .threads = 2}), meant) << text;
  }
}

TEST(Slopes, OfSlopesAndStepsThereAreNone) {
  const Picture picture = render(
      "a = Dx(Dx(x * x))\nb = Dy(floor(7 * y))\nc = filterwidth(width)\n", {.antialias = plain()});
  for (const char* name : {"a", "b", "c"})
    for (const float value : picture.plane(name)) EXPECT_EQ(value, 0) << name;
}

// The paper's own loop, printed in a program, is not touched; the library's fades by the pixel.
TEST(Slopes, OnThePlaneThePixelIsThePictures) {
  const Picture picture = render(
      "a = fbm(4 * point) - one_over_f(4 * point, 3 * pixel_freq / 4)\n"
      "b = pixel_frequency(point) - pixel_freq\n"
      "c = one_over_f([3 * y, 3 * x]) - one_over_f([3 * y, 3 * x], pixel_freq)\n",
      {.width = 40, .height = 40, .antialias = plain()});
  for (const float value : picture.plane("a")) EXPECT_NEAR(value, 0, 1e-5);
  for (const float value : picture.plane("b")) EXPECT_NEAR(value, 0, 1e-4);
  for (const float value : picture.plane("c")) EXPECT_NEAR(value, 0, 1e-5);
}

TEST(Slopes, HowManyOctavesIsNoEdge) {
  const std::string text = "c = turbulence([x y 0] / (1.3 - y))\n";
  // What is looked at is the noise itself.
  const Counts counts = render(text, {.antialias = procedural()}).counts;
  EXPECT_EQ(counts.filtered, counts.supersampled);
  EXPECT_EQ(counts.blended, 0);
}

}  // namespace
}  // namespace pse::antialias::test
