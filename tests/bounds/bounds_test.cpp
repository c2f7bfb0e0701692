// Bounds by hand, and the promise itself: no place of a box gives a value outside the bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "bounded.h"

namespace pse::bounds {
namespace {

using test::Bounded;
using test::Place;

constexpr float inf = std::numeric_limits<float>::infinity();

// What a program expects changes no bound.
TEST(Bounds, ExpectationsHandTheirValuesOn) {
  const test::Bounded bounded("c = expect(2 * x, x < 0.5, \"too large\") + 1");
  const auto [low, high] = bounded.over({-1, 0, 0}, {3, 0, 0});
  EXPECT_LE(low, -1);
  EXPECT_GE(low, -1.0001f);
  EXPECT_GE(high, 7);
  EXPECT_LE(high, 7.0001f);
}

TEST(Bounds, OfOperatorsByHand) {
  struct Case {
    const char* expression;
    float lo, hi;  // for x in [-1, 2], y in [3, 5]
  };
  for (const Case& c : std::vector<Case>{{"x + y", 2, 7},
                                         {"x - y", -6, -1},
                                         {"x * y", -5, 10},
                                         {"x * x", 0, 4},
                                         {"-2 * x", -4, 2},
                                         {"x - x", 0, 0},
                                         {"x / y", -1.0f / 3, 2.0f / 3},
                                         {"y / x", -inf, inf},
                                         {"abs(x)", 0, 2},
                                         {"abs(x - 4)", 2, 5},
                                         {"sqrt(y - 2)", 1, std::sqrt(3.0f)},
                                         {"sqrt(x)", -inf, inf},
                                         {"min(x, 0.5)", -1, 0.5f},
                                         {"max(x, y)", 3, 5},
                                         {"floor(x / 2)", -1, 1},
                                         {"fract(x)", 0, 1},
                                         {"fract(0.1 * y)", 0.3f, 0.5f},
                                         {"x < y ? 7 : x", 7, 7},
                                         {"x > 0 ? x : 9", 0, 9},
                                         {"x < 1 ? 3 : 4", 3, 4},
                                         {"x ^ 2", 0, 4},
                                         {"fma(x, 2, y)", 1, 9},
                                         {"0 * exp(100 * y)", -inf, inf},
                                         {"Noise(100 * x)", -0.95f, 0.95f}}) {
    const auto found =
        Bounded(std::string("c = ") + c.expression + "\n").over({-1, 3, 0}, {2, 5, 0});
    EXPECT_FLOAT_EQ(found[0], c.lo) << c.expression;
    EXPECT_FLOAT_EQ(found[1], c.hi) << c.expression;
  }
}

TEST(Bounds, ConditionsNarrowWhatTheyCompare) {
  // Without that, a power of numbers below 0 could be NaN.
  const Bounded program("if x <= 0\n    c = 0\nelse\n    c = x ^ 1.5\n");
  const auto found = program.over({-1, 0, 0}, {4, 0, 0});
  EXPECT_NEAR(found[0], 0, 1e-6);
  EXPECT_NEAR(found[1], 8, 1e-4);
}

TEST(Bounds, OfLoopsThatEndAtDifferentTurns) {
  // Doubled until above 10: x = 1 gives 16 and x = 3 gives 12; between them 20 is approached.
  const Bounded program("c = x\nwhile c <= 10\n    c *= 2\n");
  const auto found = program.over({1, 0, 0}, {3, 0, 0});
  EXPECT_LE(found[0], 10.001f);
  EXPECT_GE(found[1], 20);
  EXPECT_LE(found[1], 24);
  // One that may never end is stopped, and nothing is known.
  const auto endless = Bounded("c = x\nwhile c > 0\n    c += y\n").over({1, -0.001f, 0}, {2, 0, 0});
  EXPECT_EQ(endless[0], -inf);
  EXPECT_EQ(endless[1], inf);
}

// Random boxes of all sizes in [-2, 2]^3 and random places in them, corners among them.
void expect_sound(const Bounded& program, const std::string& what, int boxes = 256, int places = 16,
                  int* proven = nullptr) {
  std::mt19937 random(20261128);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Place> low, high, inside;
  for (int b = 0; b < boxes; ++b) {
    const float size = std::exp2(-10 * unit(random));
    Place l, h;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      l[axis] = 4 * unit(random) - 2;
      h[axis] = l[axis] + size * (0.5f + unit(random));
    }
    low.push_back(l), high.push_back(h);
    for (int p = 0; p < places; ++p) {
      Place at;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float t = p < 8 ? float(p >> axis & 1) : unit(random);
        at[axis] = std::min(std::max(std::lerp(l[axis], h[axis], t), l[axis]), h[axis]);
      }
      inside.push_back(at);
    }
  }
  const auto ends = program.over(low, high);
  const auto values = program.at(inside);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t b = i / static_cast<std::size_t>(places);
    const float lo = ends.lo[b], hi = ends.hi[b], value = values[i];
    ASSERT_FALSE(std::isnan(lo) || std::isnan(hi)) << what;
    if (std::isnan(value)) {
      ASSERT_TRUE(lo == -inf && hi == inf) << what << " is NaN at " << inside[i][0];
    } else {
      ASSERT_TRUE(lo <= value && value <= hi)
          << what << " is " << value << " at " << inside[i][0] << " " << inside[i][1] << " "
          << inside[i][2] << ", its bounds " << lo << " " << hi << " over a box of "
          << high[b][0] - low[b][0];
    }
  }
  if (proven != nullptr)
    *proven = static_cast<int>(std::ranges::count_if(ends.hi, [](float hi) { return hi <= 0; }));
}

TEST(Bounds, HoldEveryOperatorAndFunction) {
  for (const char* expression : {"x + y",
                                 "x - y",
                                 "x * y",
                                 "x * x - y",
                                 "3 * x * x",
                                 "x / y",
                                 "1 / x",
                                 "y / 3",
                                 "fma(x, y, z)",
                                 "fma(x, x, z)",
                                 "-x",
                                 "abs(x - 2 * y)",
                                 "sqrt(x + y)",
                                 "min(x, y)",
                                 "max(x * x, y)",
                                 "floor(3 * x) * y",
                                 "round(x) + y",
                                 "ceil(x) * x",
                                 "trunc(x) * y",
                                 "fract(3 * x) * y",
                                 "mod(5 * x, 0.7)",
                                 "mod(x, y)",
                                 "select(x < y, x * x, y * y)",
                                 "sin(3 * x * y)",
                                 "cos(x - 2 * y)",
                                 "sin(1000 * x)",
                                 "tan(x * y)",
                                 "asin(x * y)",
                                 "acos(x * y)",
                                 "atan(x / y)",
                                 "atan2(x, y)",
                                 "sinh(x * y)",
                                 "cosh(x * y)",
                                 "tanh(x - y)",
                                 "exp(x * y)",
                                 "exp2(9 * x)",
                                 "expm1(x * y)",
                                 "log(x + y)",
                                 "log2(x * y)",
                                 "log10(x)",
                                 "log1p(x)",
                                 "pow(x, 2.5)",
                                 "pow(2 + x, y)",
                                 "pow(x, -2)",
                                 "x ^ 6",
                                 "x ^ 5",
                                 "x ^ -1",
                                 "x ^ y",
                                 "cbrt(x - 2 * y)",
                                 "hypot(x, y)",
                                 "Noise(x)",
                                 "Noise(4 * x, 3 * y)",
                                 "Noise(4 * point)",
                                 "Noise(17 * point)",
                                 "Noise(x, y, z, x * y)",
                                 "unoise(point)",
                                 "noise1985(3 * point)",
                                 "noise1989(3 * point)",
                                 "book_noise(point)",
                                 "sum(Dnoise(3 * point))",
                                 "sum(vnoise(2 * point))",
                                 "Noise(2 * x, y, period = 4, seed = 3)",
                                 "length(point)",
                                 "smoothstep(0, 1, x * y)",
                                 "bias(0.3, x)",
                                 "gain(0.7, y)",
                                 "hash(point)",
                                 "turbulence_octaves(point, 5)",
                                 "turbulence_up_to(2 * point, 6, 0.4)",
                                 "fbm_between(2 * point, 6, -0.1, 0.1)",
                                 "ridges(point)",
                                 "x == y",
                                 "x != y",
                                 "not (x < y)",
                                 "x < y and y < z",
                                 "x < y or z > 0",
                                 "(x < 1) == (y < 1)",
                                 "isnan(sqrt(x))",
                                 "x / 0",
                                 "exp(200 * x) * y"})
    expect_sound(Bounded(std::string("c = 0 + (") + expression + ")\n"), expression);
}

TEST(Bounds, HoldControlFlowAndArrays) {
  for (const char* text :
       {"if x < y\n    c = x * x\nelse\n    c = sin(y)\n",
        "c = x\nfor i in [1 .. 5]\n    c = c * y + x\n",
        "c = x\nn = 0\nwhile c < 3 and n < 20\n    c = c * 1.7 + y\n    n += 1\nc += n\n",
        "function f(a, b)\n    if a > b\n        return a * b\n    return a + b * b\nc = f(x, y) + "
        "f(y, x)\n",
        "a = array(8)\nfor i in [1 .. 4]\n    a[i] = x * i + y\nc = 0\nfor v in a\n    c += v * "
        "v\n",
        "a = array(8)\nfor i in [1 .. 4]\n    a[i] = i * i\nc = a[1 + floor(abs(x))] + a[2]\n",
        "c = 0\nfor i in [1 .. 9]\n    if i * x > 2\n        break\n    c += x * i\n",
        "c = 0\nfor i in [1 .. 3]\n    n = 0\n    while n < abs(3 * x)\n        c += y\n        n "
        "+= 1\n",
        "m = [[x y] [y 2]]\nv = m * [x 1]\nc = v.x * v.y\n",
        "c = 1\nif x > 0\n    if y > 0\n        c = x ^ y\n    else\n        c = log(x)\n"})
    expect_sound(Bounded(text), text);
}

TEST(Bounds, CompiledTheyAreTheSame) {
  const std::string text =
      "c = 0\nq = point\nwhile norm(q) < 3\n    q *= 1.5 + 0.2 * Noise(3 * q)\n    c += bias(0.4, "
      "saturate(1 - norm(q)))\n";
  const Bounded one(text), other(text, "c", false);
  std::vector<Place> low, high;
  for (int i = 0; i < 100; ++i) {
    const float t = float(i) / 50 - 1;
    low.push_back({t, 0.3f * t, -t}), high.push_back({t + 0.02f, 0.3f * t + 0.01f, -t + 0.03f});
  }
  EXPECT_EQ(one.over(low, high).lo, other.over(low, high).lo);
  EXPECT_EQ(one.over(low, high).hi, other.over(low, high).hi);
}

}  // namespace

// For the gallery's test.
void expect_sound_density(const test::Bounded& program, const std::string& what, int* proven) {
  expect_sound(program, what, 512, 16, proven);
}

}  // namespace pse::bounds
