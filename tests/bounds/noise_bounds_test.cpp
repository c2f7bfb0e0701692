// The limits of the 2002 noise: found again on a grid with free gradients, and held at random.
#include "bounds/noise_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pse::bounds {
namespace {

// The fade and its two derivatives.
std::array<double, 3> fade(double t) {
  return {t * t * t * (t * (6 * t - 15) + 10), 30 * t * t * (t - 1) * (t - 1),
          60 * t * (t - 1) * (2 * t - 1)};
}

// The worst at one place of a cell: value, slope along an axis, half of the second derivative along
// a diagonal; each corner has the gradient that is worst for it alone.
template <std::size_t N>
std::array<double, 3> worst_at(const std::array<double, N>& x) {
  const auto tables = num::gradient_tables(N);
  const std::size_t entries = tables[0].entries.size();
  constexpr std::size_t diagonals = std::size_t{1} << (N - 1);
  double value = 0;
  std::array<double, N> slope{};
  std::array<double, diagonals> bend{};
  for (std::size_t corner = 0; corner < std::size_t{1} << N; ++corner) {
    std::array<std::array<double, 3>, N> w;
    std::array<double, N> way;
    for (std::size_t i = 0; i < N; ++i) {
      const bool high = (corner >> i & 1) != 0;
      w[i] = fade(x[i]);
      if (!high) w[i] = {1 - w[i][0], -w[i][1], -w[i][2]};
      way[i] = x[i] - (high ? 1 : 0);
    }
    // The weight differentiated `of` times by each axis.
    const auto weight = [&](std::array<std::size_t, N> of) {
      double product = 1;
      for (std::size_t i = 0; i < N; ++i) product *= w[i][of[i]];
      return product;
    };
    const auto once = [&](std::size_t i) {
      std::array<std::size_t, N> of{};
      ++of[i];
      return weight(of);
    };
    double v = 0;
    std::array<double, N> s{};
    std::array<double, diagonals> b{};
    for (std::size_t e = 0; e < entries; ++e) {
      double along = 0;
      for (std::size_t i = 0; i < N; ++i) along += double(tables[i].entries[e]) * way[i];
      v = std::max(v, std::abs(weight({}) * along));
      for (std::size_t i = 0; i < N; ++i)
        s[i] =
            std::max(s[i], std::abs(once(i) * along + weight({}) * double(tables[i].entries[e])));
      for (std::size_t d = 0; d < diagonals; ++d) {
        const auto sign = [&](std::size_t i) { return i > 0 && (d >> (i - 1) & 1) ? -1.0 : 1.0; };
        double second = 0, first = 0, gradient = 0;
        for (std::size_t i = 0; i < N; ++i) {
          first += once(i) * sign(i);
          gradient += double(tables[i].entries[e]) * sign(i);
          for (std::size_t j = 0; j < N; ++j) {
            std::array<std::size_t, N> of{};
            ++of[i], ++of[j];
            second += weight(of) * sign(i) * sign(j);
          }
        }
        b[d] = std::max(b[d], std::abs(second * along + 2 * first * gradient) / 2);
      }
    }
    value += v;
    for (std::size_t i = 0; i < N; ++i) slope[i] += s[i];
    for (std::size_t d = 0; d < diagonals; ++d) bend[d] += b[d];
  }
  return {value, *std::ranges::max_element(slope), *std::ranges::max_element(bend)};
}

template <std::size_t N>
std::array<double, 3> worst(int steps) {
  std::array<double, 3> found{};
  std::array<int, N> at{};
  for (;;) {
    std::array<double, N> x;
    for (std::size_t i = 0; i < N; ++i) x[i] = 0.5 * at[i] / steps;
    const auto here = worst_at(x);
    for (std::size_t k = 0; k < 3; ++k) found[k] = std::max(found[k], here[k]);
    std::size_t axis = 0;
    while (axis < N && ++at[axis] > steps) at[axis++] = 0;
    if (axis == N) return found;
  }
}

TEST(NoiseBounds, TheLimitsAreThoseOfTheWorstGradients) {
  const std::array<std::array<double, 3>, 4> found = {worst<1>(200), worst<2>(40), worst<3>(12),
                                                      worst<4>(4)};
  for (std::size_t n = 0; n < 4; ++n) {
    const NoiseLimits& limits = improved_limits[n];
    const std::array<double, 3> held = {limits.value, limits.slope, limits.bend};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LE(found[n][k], held[k]) << n + 1 << " dimensions, limit " << k;
      EXPECT_GE(found[n][k], 0.85 * held[k]) << n + 1 << " dimensions, limit " << k;
    }
  }
}

TEST(NoiseBounds, HoldInSmallBoxesAndAreNarrow) {
  std::mt19937 random(1989);
  std::uniform_real_distribution<float> unit(0, 1);
  double widths = 0, truths = 0;
  for (int b = 0; b < 2000; ++b) {
    const float size = 0.02f + 0.03f * unit(random);
    std::array<Interval<float>, 3> box;
    for (auto& axis : box) {
      axis.lo = 40 * unit(random) - 20;
      axis.hi = axis.lo + size;
    }
    const auto range =
        bound_noise<1>(box, [](const auto& p) { return std::array{num::improved_noise(p)}; })[0];
    float least = 2, most = -2;
    for (int p = 0; p < 200; ++p) {
      std::array<float, 3> at;
      for (std::size_t i = 0; i < 3; ++i)
        at[i] = p < 8 ? (p >> i & 1 ? box[i].hi : box[i].lo)
                      : std::min(box[i].lo + size * unit(random), box[i].hi);
      const float value = num::improved_noise(at);
      least = std::min(least, value), most = std::max(most, value);
    }
    ASSERT_LE(range.lo, least);
    ASSERT_GE(range.hi, most);
    widths += double(range.hi) - double(range.lo);
    truths += double(most) - double(least);
  }
  EXPECT_LT(widths / truths, 2);
}

}  // namespace
}  // namespace pse::bounds
