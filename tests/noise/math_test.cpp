// The math library against the C library in double: the errors that its declarations state, special
// values, and the same bits from the IR.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "builtin_run.h"
#include "noise/math.h"

namespace pse::test {
namespace {

// The spacing of floats at v, as if there were no largest float.
double ulp(double v) {
  int exponent;
  std::frexp(v, &exponent);
  return std::ldexp(1.0, std::max(exponent - 24, -149));
}

// How far a float is from the exact value, in ulps; 0 where both are NaN, the same infinity, or the
// same zero.
double error_in_ulps(float value, double exact) {
  constexpr double overflow = 0x1.ffffffp127;  // from here on the nearest float is infinite
  if (std::isnan(exact)) return std::isnan(value) ? 0 : HUGE_VAL;
  if (std::fabs(exact) >= overflow)
    return value == std::copysign(HUGE_VALF, static_cast<float>(exact)) ? 0 : HUGE_VAL;
  if (exact == 0) return value == 0 && std::signbit(value) == std::signbit(exact) ? 0 : HUGE_VAL;
  if (!std::isfinite(value)) return HUGE_VAL;
  return std::fabs(value - exact) / ulp(exact);
}

const std::vector<float> edges = {0.0f,
                                  -0.0f,
                                  0x1p-149f,
                                  -0x1p-149f,
                                  1e-40f,
                                  -1e-40f,
                                  0x1p-126f,
                                  1e-20f,
                                  -1e-20f,
                                  1e-5f,
                                  0.25f,
                                  0.5f,
                                  -0.5f,
                                  0.49999997f,
                                  0.50000006f,
                                  0.99999994f,
                                  1.0f,
                                  -1.0f,
                                  1.0000001f,
                                  -1.0000001f,
                                  1.5f,
                                  2.0f,
                                  -2.0f,
                                  2.5f,
                                  3.0f,
                                  -3.0f,
                                  4.0f,
                                  8.0f,
                                  10.0f,
                                  100.0f,
                                  1000.0f,
                                  -104.0f,
                                  -103.9f,
                                  -87.4f,
                                  88.72f,
                                  88.73f,
                                  89.41f,
                                  89.42f,
                                  127.5f,
                                  128.0f,
                                  -149.5f,
                                  -150.0f,
                                  32767.998f,
                                  32768.0f,
                                  -32768.0f,
                                  11947.6f,
                                  16777215.0f,
                                  16777216.0f,
                                  -16777215.0f,
                                  1e10f,
                                  1e20f,
                                  3.1415927f,
                                  1.5707964f,
                                  -1.5707964f,
                                  6.2831855f,
                                  0x1.921fb4p0f,
                                  1.6e38f,
                                  0x1.fffffep127f,
                                  -0x1.fffffep127f,
                                  HUGE_VALF,
                                  -HUGE_VALF,
                                  std::nanf("")};

// Edges, evenly spaced and random arguments in a range, and random bits.
std::vector<float> arguments(float low, float high) {
  std::vector<float> list = edges;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> inside(low, high);
  for (int i = 0; i <= 20000; ++i) {
    list.push_back(low + (high - low) * static_cast<float>(i) / 20000.0f);
    list.push_back(inside(random));
    const auto any = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isnan(any)) list.push_back(any);
  }
  return list;
}

struct OfOne {
  const char* name;
  float (*ours)(const float&);
  double (*exact)(double);
  float low, high;  // where arguments are dense
  double bound;     // as declared
};
const OfOne of_one[] = {
    {"exp", num::exp<float>, std::exp, -104, 89, 1.1},
    {"exp2", num::exp2<float>, std::exp2, -150, 128, 1},
    {"expm1", num::expm1<float>, std::expm1, -2, 2, 1.5},
    {"expm1", num::expm1<float>, std::expm1, -20, 89, 1.5},
    {"log", num::log<float>, std::log, 0.3f, 3, 1},
    {"log2", num::log2<float>, std::log2, 0.3f, 3, 1.2},
    {"log10", num::log10<float>, std::log10, 0.3f, 3, 1.2},
    {"log1p", num::log1p<float>, std::log1p, -1, 3, 1.5},
    {"sin", num::sin<float>, std::sin, -10, 10, 1.7},
    {"sin", num::sin<float>, std::sin, -40000, 40000, 1.7},
    {"cos", num::cos<float>, std::cos, -10, 10, 1.7},
    {"cos", num::cos<float>, std::cos, -40000, 40000, 1.7},
    {"tan", num::tan<float>, std::tan, -10, 10, 1.1},
    {"tan", num::tan<float>, std::tan, -40000, 40000, 1.1},
    {"asin", num::asin<float>, std::asin, -1, 1, 1.8},
    {"acos", num::acos<float>, std::acos, -1, 1, 1.3},
    {"atan", num::atan<float>, std::atan, -4, 4, 1.5},
    {"sinh", num::sinh<float>, std::sinh, -3, 3, 1.7},
    {"cosh", num::cosh<float>, std::cosh, -3, 3, 1.6},
    {"sinh", num::sinh<float>, std::sinh, -90, 90, 1.7},
    {"cosh", num::cosh<float>, std::cosh, -90, 90, 1.6},
    {"tanh", num::tanh<float>, std::tanh, -10, 10, 1.5},
    {"cbrt", num::cbrt<float>, std::cbrt, -9, 9, 0.8},
};

TEST(Math, ErrorsAreAsDeclared) {
  for (const OfOne& function : of_one) {
    double worst = 0;
    float at = 0;
    for (const float x : arguments(function.low, function.high)) {
      const double error = error_in_ulps(function.ours(x), function.exact(x));
      if (error > worst) {
        worst = error;
        at = x;
      }
    }
    EXPECT_LE(worst, function.bound) << function.name << " at " << at;
    // A bound far from the truth would tell nothing.
    EXPECT_GE(worst, 0.5 * function.bound) << function.name;
  }
}

struct OfTwo {
  const char* name;
  float (*ours)(const float&, const float&);
  double (*exact)(double, double);
  double bound;           // as declared
  double per_octave = 0;  // that the result is away from 1
};
const OfTwo of_two[] = {{"pow", num::pow<float>, std::pow, 1, 1.0 / 18},
                        {"atan2", num::atan2<float>, std::atan2, 1.7},
                        {"hypot", num::hypot<float>, std::hypot, 1.3}};

TEST(Math, ErrorsOfTwoArgumentsAreAsDeclared) {
  for (const OfTwo& function : of_two) {
    const auto check = [&](float x, float y) {
      const double exact = function.exact(x, y), error = error_in_ulps(function.ours(x, y), exact);
      const double octaves =
          exact == 0 || !std::isfinite(exact) ? 0 : std::fabs(std::log2(std::fabs(exact)));
      EXPECT_LE(error, function.bound + octaves * function.per_octave)
          << function.name << "(" << x << ", " << y << ")";
    };
    for (const float x : edges) {
      for (const float y : edges) check(x, y);
    }
    std::mt19937 random(8);
    std::uniform_real_distribution<float> base(0.0f, 4.0f), exponent(-60.0f, 60.0f);
    for (int i = 0; i < 40000; ++i) {
      check(base(random), exponent(random));
      check(std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0xff7fffffu),
            std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0xff7fffffu));
    }
  }
}

// Bases near 1 with powers that take them to the ends of the range, where the logarithm's last bits
// count most; and that the error there is not far below what is declared.
TEST(Math, PowersOfNumbersNearOne) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> base(-0.1, 0.1), octaves(-126, 127);
  double worst = 0, most = 0;
  for (int i = 0; i < 60000; ++i) {
    const auto x = static_cast<float>(1 + base(random));
    if (x == 1) continue;
    const double wanted = octaves(random);
    const auto y = static_cast<float>(wanted / std::log2(static_cast<double>(x)));
    const double error = error_in_ulps(num::pow(x, y), std::pow(static_cast<double>(x), y));
    EXPECT_LE(error, 1 + std::fabs(wanted) / 18) << x << " ^ " << y;
    worst = std::max(worst, error);
    if (std::fabs(wanted) < 4) most = std::max(most, error);
  }
  EXPECT_GE(worst, 4);
  EXPECT_GE(most, 0.6);
}

TEST(Math, ExactValues) {
  EXPECT_EQ(num::cos(0.0f), 1.0f);
  EXPECT_EQ(num::exp(0.0f), 1.0f);
  EXPECT_EQ(num::log(1.0f), 0.0f);
  EXPECT_EQ(num::log10(1000.0f), 3.0f);
  for (int k = -149; k < 128; ++k) {
    const float power = std::ldexp(1.0f, k);
    EXPECT_EQ(num::exp2(static_cast<float>(k)), power);
    EXPECT_EQ(num::log2(power), static_cast<float>(k));
    EXPECT_EQ(num::pow(2.0f, static_cast<float>(k)), power);
  }
  for (const float x : {0.1f, 0.7f, 3.0f, 1e-30f, 1e30f, -2.7f}) {
    EXPECT_EQ(num::pow(x, 1.0f), x);
    EXPECT_EQ(num::pow(x, 0.0f), 1.0f);
  }
  for (int k = -9; k <= 9; ++k)
    EXPECT_EQ(num::cbrt(static_cast<float>(k * k * k)), static_cast<float>(k));
}

TEST(Math, FlooredRemainder) {
  EXPECT_EQ(num::mod(7.0f, 3.0f), 1.0f);
  EXPECT_EQ(num::mod(-7.0f, 3.0f), 2.0f);
  EXPECT_EQ(num::mod(7.0f, -3.0f), -2.0f);
  EXPECT_EQ(num::mod(-7.0f, -3.0f), -1.0f);
  EXPECT_EQ(num::mod(5.25f, 0.5f), 0.25f);
  EXPECT_TRUE(std::isnan(num::mod(1.0f, 0.0f)));
  // 3 b rounds down below three times b, and the quotient up to 3.
  std::mt19937 random(9);
  std::uniform_real_distribution<float> any(-1000.0f, 1000.0f), divisor(0.001f, 10.0f);
  for (int i = 0; i < 20000; ++i) {
    const float b = divisor(random), r = num::mod(any(random), b);
    EXPECT_TRUE(r >= 0.0f && r <= b) << r << " of " << b;
    const float k = num::mod(b * static_cast<float>(i % 50), b);
    EXPECT_TRUE(k >= 0.0f && k <= b) << k << " of " << b;
  }
}

// A NaN's bits do not reach a result.
TEST(Math, NanInNanOut) {
  for (const std::uint32_t bits :
       {0x7fc00000u, 0xffc00000u, 0x7f800001u, 0xffffffffu, 0x7fc12345u}) {
    const auto nan = std::bit_cast<float>(bits);
    for (const OfOne& function : of_one)
      EXPECT_TRUE(std::isnan(function.ours(nan))) << function.name;
    for (const OfTwo& function : of_two) {
      EXPECT_TRUE(std::isnan(function.ours(nan, 0.5f))) << function.name;
      EXPECT_TRUE(std::isnan(function.ours(0.5f, nan))) << function.name;
    }
  }
}

TEST(Math, IrGivesTheSameBits) {
  std::mt19937 random(10);
  std::vector<float> list = edges;
  for (int i = 0; i < 300; ++i) {
    list.push_back(std::ldexp(static_cast<float>(random()) * 0x1p-31f - 1.0f, i % 12 - 4));
    list.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random()) & 0xff7fffffu));
  }
  for (const OfOne& function : of_one) {
    const BuiltinProgram program(function.name, {{0.0f}});
    for (const float x : list) {
      ASSERT_TRUE(same(program.run({x})[0], function.ours(x))) << function.name << "(" << x << ")";
    }
  }
  for (const OfTwo& function : of_two) {
    const BuiltinProgram program(function.name, {{0.0f}, {0.0f}});
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      ASSERT_TRUE(same(program.run({list[i], list[i + 1]})[0], function.ours(list[i], list[i + 1])))
          << function.name << "(" << list[i] << ", " << list[i + 1] << ")";
    }
  }
}

}  // namespace
}  // namespace pse::test
