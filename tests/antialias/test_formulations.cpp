// One edge said in many ways is the same edge: half-planes against the exact response of the
// kernel, whatever the condition looks like and wherever the edge meets the pixels. And what is
// thinner than a pixel, or has no condition of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr double one_step = 1.0 / 255;
constexpr int size = 16;

std::string text(double value) { return "(" + std::to_string(value) + ")"; }

// `_q`: pixels from the line through (x, y) whose normal has the angle, positive on its side.
std::string line(double degrees, double x, double y) {
  const double angle = degrees * std::numbers::pi / 180;
  return "_q = " + text(std::cos(angle)) + " * (u * 16 - " + text(x) + ") + " +
         text(std::sin(angle)) + " * ((1 - v) * 16 - " + text(y) + ")\n";
}

Picture draw(const std::string& program) {
  return render(program,
                {.width = size, .height = size, .interpret = true, .antialias = procedural()});
}

TEST(Formulations, OfOneHalfPlaneAreTheSameEdge) {
  for (const char* program :
       {"c = _q > 0 ? 1 : 0\n",
        "c = _q < 0 ? 0 : 1\n",
        "c = 0 <= _q\n",
        "c = step(0, _q)\n",
        "c = 0.5 + 0.5 * sign(_q)\n",
        "c = 1 + floor(_q / 1000)\n",
        "c = round(0.5 + _q / 1000)\n",
        "c = select(1000000 * _q > 0, 1, 0)\n",
        "c = select(0.000001 * _q > 0, 1, 0)\n",
        "c = smoothstep(0, 0, _q)\n",
        "c = saturate(1000 * _q + 0.35)\n",
        "c = _q % 1000 < 500\n",
        "c = abs(_q - 500) < 500\n",
        "c = (_q - 1000) ^ 2 < 1000000\n",
        "c = 0.5 + 0.5 * _q / abs(_q)\n",
        "c = cbrt(_q) > 0\n",
        "c = 0.5 < cbrt(_q + 0.125)\n",
        "c = sqrt(_q) > 0\n",
        "c = not (0 >= sqrt(max(0, _q)))\n",
        "c = atan2(_q, -1) > 0\n",
        "c = 0.5 + atan2(_q, -1000) / TAU\n",
        "c = 0\nfor i in [1 .. 3]\n    if _q > 0\n        c = 1\n        break\n",
        "function f(q)\n    if q > 0\n        return 1\n    return 0\nc = f(_q)\n",
        "_z = _q\nc = 1\nwhile _z < 0\n    _z = 1\n    c = 0\n"})
    for (const double degrees : {0.0, 0.01, 45.0, 77.0, 133.0, 269.9})
      // Through the corner of four pixels, the middle of one, and neither.
      for (const double at : {8.0, 8.5, 8.13}) {
        const Picture picture = draw(line(degrees, at, at) + program);
        const double angle = degrees * std::numbers::pi / 180;
        double worst = 0;
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            const double d = (x + 0.5 - at) * std::cos(angle) + (y + 0.5 - at) * std::sin(angle);
            worst = std::max(worst, std::abs(picture.at(x, y) -
                                             double(Filter().share(static_cast<float>(d), 1, 0))));
          }
        EXPECT_LT(worst, 1.05 * one_step) << program << degrees << " through " << at;
      }
}

// The slope of a power is 0 at its edge: f / |f'| is a third of the distance of a cube.
TEST(Formulations, APowerOfADistanceIsTheSameEdge) {
  for (const char* program : {"c = _q ^ 3 > 0 ? 1 : 0\n", "c = _q ^ 5 > 0 ? 1 : 0\n"})
    for (const double degrees : {0.01, 45.0, 77.0, 133.0}) {
      const Picture picture = draw(line(degrees, 8.13, 8.13) + program);
      const double angle = degrees * std::numbers::pi / 180;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const double d = (x + 0.5 - 8.13) * std::cos(angle) + (y + 0.5 - 8.13) * std::sin(angle);
          EXPECT_NEAR(picture.at(x, y), Filter().share(static_cast<float>(d), 1, 0),
                      1.05 * one_step)
              << program << degrees << ": " << x << ' ' << y;
        }
    }
}

// A line of a third of a pixel is broken nowhere, where it passes between samples for many rows
// too: the exact response is the difference of those of its edges. Samples tell it, 32 of them.
TEST(Formulations, ThinLinesAreWhole) {
  for (const char* program : {"c = abs(_q - 1 / 6) < 1 / 6\n", "c = fract(_q / 100) < 1 / 300\n",
                              "c = abs(fract((_q - 1 / 6) / 100) - 0.5) > 0.5 - 1 / 600\n",
                              "c = 1 - step(1 / 3, _q % 50)\n"})
    for (const double degrees : {0.7, 3.0, 92.0, 359.0}) {
      const Picture picture = draw(line(degrees, 8.2, 8.5) + program);
      const double angle = degrees * std::numbers::pi / 180;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          const double q = (x + 0.5 - 8.2) * std::cos(angle) + (y + 0.5 - 8.5) * std::sin(angle);
          const auto share = [](double d) { return Filter().share(static_cast<float>(d), 1, 0); };
          EXPECT_NEAR(picture.at(x, y), share(q) - share(q - 1.0 / 3), 0.12)
              << program << degrees << ": " << x << ' ' << y;
        }
    }
}

// A ramp as programs draw it to smooth an edge themselves: its mean over the pixel, by the exact
// weights of the kernel (12 / pi) sqrt(1/4 - r^2), whose projection is 6 (1/4 - t^2).
TEST(Formulations, ARampIsSmoothedToo) {
  const Picture picture = draw(line(0, 8.27, 8) + "c = smoothstep(-0.8, 0.8, _q)\n");
  for (int x = 4; x < 12; ++x) {
    double mean = 0;
    constexpr int steps = 1000;
    for (int k = 0; k < steps; ++k) {
      const double t = (k + 0.5) / steps - 0.5;
      const double s = std::clamp((x + 0.5 + t - 8.27 + 0.8) / 1.6, 0.0, 1.0);
      mean += 6 * (0.25 - t * t) * s * s * (3 - 2 * s) / steps;
    }
    EXPECT_NEAR(picture.at(x, 8), mean, 3 * one_step) << x;
  }
}

}  // namespace
}  // namespace pse::antialias::test
