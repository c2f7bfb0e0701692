// The noise functions against known numbers and against a second implementation in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "noise/book_noise.h"
#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "reference.h"

namespace pse::test {
namespace {

using Point = std::array<float, 3>;

TEST(NoiseValues, ImprovedHasTheReferenceNumbers) {
  for (const NoiseValue& known : improved_values) {
    EXPECT_NEAR(num::improved_noise(known.point), known.noise, 2e-6) << known.point[0];
    const auto slope = num::gradient(num::improved_noise(num::variables(known.point)));
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(slope[k], known.gradient[k], 1e-5) << known.point[0];
  }
  // The largest value of a period.
  EXPECT_NEAR(num::improved_noise(Point{12.355257f, 187.518508f, 5.5f}), 1.0363538, 2e-6);
}

TEST(NoiseValues, BookHasTheListingsNumbers) {
  for (const auto& [point, noise] : book_values)
    EXPECT_NEAR(num::book_noise(point), noise, 2e-7) << point[0];
  // Its table is no permutation: 137 is missing, 0 is there twice, 77 entries never moved, 76 of
  // them odd.
  const auto entries = num::book_permutation().entries;
  EXPECT_EQ(std::ranges::count(entries, 137), 0);
  EXPECT_EQ(std::ranges::count(entries, 0), 2);
  int kept = 0, kept_odd = 0;
  for (std::size_t i = 0; i < 256; ++i) {
    kept += entries[i] == i;
    kept_odd += entries[i] == i && i % 2 == 1;
  }
  EXPECT_EQ(kept, 77);
  EXPECT_EQ(kept_odd, 76);
  // Positions are rounded to 1/1024.
  EXPECT_EQ(num::book_noise(Point{0.3f, 0.7f, 1.9f}),
            num::book_noise(Point{0.3001f, 0.7001f, 1.9001f}));
}

double quintic(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
double cubic(double t) { return t * t * (3 - 2 * t); }

template <std::size_t N>
void agrees_with_wavelet_sum() {
  std::array<std::size_t, N> forward, backward;
  std::iota(forward.begin(), forward.end(), 0u);
  std::ranges::reverse_copy(forward, backward.begin());
  std::mt19937 random(N);
  std::uniform_real_distribution<float> coordinate(-256.0f, 256.0f);
  for (int i = 0; i < 2000; ++i) {
    std::array<float, N> p;
    for (float& x : p) x = coordinate(random) * (i % 10 == 0 ? 4096.0f : 1.0f);
    const double improved = wavelet_sum<N>(p, forward, num::gradient_tables(N), quintic);
    EXPECT_NEAR(num::improved_noise(p), improved, 3e-6) << N << "-D at " << p[0];
    const double of_1989 = wavelet_sum<N>(p, backward, num::sphere_tables(N), cubic);
    EXPECT_NEAR(num::noise_1989(p), of_1989, 2e-6) << N << "-D at " << p[0];
  }
}
TEST(NoiseValues, AgreeWithTheSumOfWavelets) {
  agrees_with_wavelet_sum<1>();
  agrees_with_wavelet_sum<2>();
  agrees_with_wavelet_sum<3>();
  agrees_with_wavelet_sum<4>();
}

TEST(NoiseValues, ZeroAtWholePositions) {
  for (float k = -300; k < 300; k += 7) {
    EXPECT_EQ(num::improved_noise(Point{k, 2 * k, 5}), 0.0f);
    EXPECT_EQ(num::noise_1989(Point{k, 2 * k, 5}), 0.0f);
    EXPECT_EQ(num::book_noise(Point{k, 2 * k, 5}), 0.0f);
  }
  EXPECT_EQ(num::improved_noise(Point{1e30f, -3e9f, 16777216.0f}), 0.0f);
  EXPECT_TRUE(std::isnan(num::improved_noise(Point{HUGE_VALF, 0.5f, 0.5f})));
  EXPECT_TRUE(std::isnan(num::improved_noise(Point{0.5f, std::nanf(""), 0.5f})));
}

// At a lattice point the noise of 1985 is that point's value, and its derivative that point's
// gradient; both are spread evenly over [-1, 1], of which the variance is 1/3, and are
// uncorrelated.
TEST(NoiseValues, LatticeEquationsOf1985) {
  double value2 = 0, slope2 = 0, mixed = 0;
  const int side = 20;
  for (int i = 0; i < side * side * side; ++i) {
    const Point p = {static_cast<float>(i % side - 10), static_cast<float>(i / side % side - 10),
                     static_cast<float>(i / side / side - 10)};
    const auto noise = num::noise_1985(num::variables(p));
    const auto slope = num::gradient(noise);
    EXPECT_LE(std::fabs(noise.value), 1.0f);
    value2 += noise.value * noise.value;
    for (const float s : slope) {
      EXPECT_LE(std::fabs(s), 1.0f);
      slope2 += s * s / 3;
      mixed += s * noise.value;
    }
    mixed += slope[0] * slope[1] + slope[1] * slope[2] + slope[2] * slope[0];
  }
  const double count = side * side * side;
  EXPECT_NEAR(value2 / count, 1.0 / 3, 0.01);
  EXPECT_NEAR(slope2 / count, 1.0 / 3, 0.01);
  EXPECT_NEAR(mixed / count, 0, 0.03);
}

TEST(NoiseValues, SphereTablesAreOnTheSphere) {
  for (std::size_t n = 2; n <= 4; ++n) {
    const auto tables = num::sphere_tables(n);
    for (std::size_t i = 0; i < 256; ++i) {
      double square = 0;
      for (const auto& table : tables)
        square += static_cast<double>(table.entries[i]) * table.entries[i];
      EXPECT_NEAR(square, 1, 2e-7);
    }
    for (const auto& table : tables) {
      EXPECT_NEAR(std::accumulate(table.entries.begin(), table.entries.end(), 0.0) / 256, 0, 0.1);
    }
  }
}

}  // namespace
}  // namespace pse::test
