// What the noise functions are as random functions: variance, energy of derivatives, seeds,
// periods, smoothness.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "noise/book_noise.h"
#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "noise/seed.h"

namespace pse::test {
namespace {

template <std::size_t N>
std::vector<std::array<float, N>> random_points(int count, float low = 0.0f, float high = 256.0f) {
  std::mt19937 random(N + 40);
  std::uniform_real_distribution<float> coordinate(low, high);
  std::vector<std::array<float, N>> points(static_cast<std::size_t>(count));
  for (auto& point : points) {
    for (float& x : point) x = coordinate(random);
  }
  return points;
}

template <std::size_t N, class Function>
double mean_square(const Function& function) {
  double sum = 0;
  const auto points = random_points<N>(200000);
  for (const auto& p : points) {
    const double value = function(p);
    sum += value * value;
  }
  return sum / static_cast<double>(points.size());
}

// Closed forms for independent gradients: the sum over wavelets of the integral of their squares.
TEST(NoiseStatistics, VarianceIsTheClosedForm) {
  const auto near = [](double found, double expected) {
    EXPECT_NEAR(found / expected, 1, 0.025) << expected;
  };
  near(mean_square<3>([](const auto& p) { return num::improved_noise(p); }), 0.072918945691);
  near(mean_square<2>([](const auto& p) { return num::improved_noise(p); }), 2 * 0.046531150427);
  near(mean_square<3>([](const auto& p) { return num::noise_1989(p); }), 0.033285390347);
  // The closed form for the listing is 0.07489; its defective table gives 0.078949, measured with
  // the C program.
  near(mean_square<3>([](const auto& p) { return num::book_noise(p); }), 0.078949);
}

TEST(NoiseStatistics, DerivativeEnergyOfTheImprovedNoise) {
  std::array<double, 3> energy{};
  const auto points = random_points<3>(200000);
  for (const auto& p : points) {
    const auto slope = num::gradient(num::improved_noise(num::variables(p)));
    for (std::size_t k = 0; k < 3; ++k)
      energy[k] += slope[k] * slope[k] / static_cast<double>(points.size());
  }
  EXPECT_NEAR(energy[0] / (77205550.0 / 160243083.0), 1, 0.03);
  EXPECT_NEAR(energy[1] / (84125180.0 / 160243083.0), 1, 0.03);
  EXPECT_NEAR(energy[2] / (77205550.0 / 160243083.0), 1, 0.03);
  EXPECT_NEAR(energy[1] / energy[0], 1.0896260696, 0.02);
}

// Correlation of two functions over random points.
template <std::size_t N>
double correlation(const std::function<double(const std::array<float, N>&)>& a,
                   const std::function<double(const std::array<float, N>&)>& b) {
  double aa = 0, ab = 0, bb = 0;
  for (const auto& p : random_points<N>(20000)) {
    const double u = a(p), v = b(p);
    aa += u * u;
    ab += u * v;
    bb += v * v;
  }
  return ab / std::sqrt(aa * bb);
}

template <std::size_t N>
void seeds_differ() {
  using Function = std::function<double(const std::array<float, N>&)>;
  const auto seeded = [](float seed) {
    return Function([seed](const auto& p) {
      return num::improved_noise(p,
                                 num::NoiseOptions<float, N>{std::nullopt, num::key_of_seed(seed)});
    });
  };
  const Function plain = [](const auto& p) { return num::improved_noise(p); };
  EXPECT_NEAR(correlation<N>(plain, seeded(0.0f)), 1, 1e-9);
  EXPECT_NEAR(correlation<N>(plain, seeded(-0.0f)), 1, 1e-9);
  const double limit = N == 1 ? 0.3 : 0.08;
  for (const float seed : {1.0f, 2.0f, 3.0f, 1000.0f, -1.0f, 0.5f}) {
    EXPECT_LT(std::fabs(correlation<N>(plain, seeded(seed))), limit) << N << "-D, seed " << seed;
    EXPECT_LT(std::fabs(correlation<N>(seeded(seed + 1), seeded(seed + 2))), limit)
        << N << "-D, seed " << seed;
  }
}
TEST(NoiseStatistics, SeedsAreUncorrelated) {
  seeds_differ<1>();
  seeds_differ<2>();
  seeds_differ<3>();
  seeds_differ<4>();
}

// Along a lattice line the unseeded noise shows one sequence, shifted from line to line; a seed
// must not show it again.
TEST(NoiseStatistics, SeedsAreNotTranslations) {
  const auto line = [](float x, float seed) {
    std::vector<double> values;
    for (int z = 0; z < 256; ++z) {
      const num::NoiseOptions<float, 3> options{std::nullopt, num::key_of_seed(seed)};
      values.push_back(num::improved_noise(
          std::array<float, 3>{x, 0.0f, static_cast<float>(z) + 0.25f}, options));
    }
    return values;
  };
  // The largest correlation over all 256 shifts.
  const auto likeness = [](const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (std::size_t shift = 0; shift < 256; ++shift) {
      double aa = 0, ab = 0, bb = 0;
      for (std::size_t i = 0; i < 256; ++i) {
        aa += a[i] * a[i];
        ab += a[i] * b[(i + shift) & 255];
        bb += b[i] * b[i];
      }
      largest = std::max(largest, ab / std::sqrt(aa * bb));
    }
    return largest;
  };
  EXPECT_GT(likeness(line(0, 0), line(9, 0)), 0.999);
  for (const float seed : {1.0f, 2.0f, 77.0f}) {
    EXPECT_LT(likeness(line(0, 0), line(0, seed)), 0.35);
    EXPECT_LT(likeness(line(0, 0), line(9, seed)), 0.35);
  }
}

template <std::size_t N>
void vector_parts_differ() {
  using Function = std::function<double(const std::array<float, N>&)>;
  const auto part = [](std::size_t k) {
    return Function([k](const auto& p) { return num::improved_vector_noise(p)[k]; });
  };
  EXPECT_NEAR(correlation<N>(part(0), [](const auto& p) { return num::improved_noise(p); }), 1,
              1e-9);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(std::fabs(correlation<N>(part(k), part((k + 1) % 3))), N == 1 ? 0.2 : 0.08)
        << N << "-D, part " << k;
  }
}
TEST(NoiseStatistics, PartsOfVectorNoiseAreUncorrelated) {
  vector_parts_differ<1>();
  vector_parts_differ<2>();
  vector_parts_differ<3>();
  vector_parts_differ<4>();
}

// A noise with options, on numbers and on duals.
template <std::size_t N>
struct Kind {
  const char* name;
  std::function<float(std::array<float, N>, num::NoiseOptions<float, N>)> value;
  std::function<std::array<float, N>(std::array<float, N>)> gradient;
  bool second_derivative;  // continuous
};
template <std::size_t N>
std::vector<Kind<N>> kinds() {
  return {{"2002", [](auto p, auto o) { return num::improved_noise(p, o); },
           [](auto p) { return num::gradient(num::improved_noise(num::variables(p))); }, true},
          {"1985", [](auto p, auto o) { return num::noise_1985(p, o); },
           [](auto p) { return num::gradient(num::noise_1985(num::variables(p))); }, false},
          {"1989", [](auto p, auto o) { return num::noise_1989(p, o); },
           [](auto p) { return num::gradient(num::noise_1989(num::variables(p))); }, false}};
}

template <std::size_t N>
void periods_hold() {
  for (const Kind<N>& kind : kinds<N>()) {
    for (const float period : {1.0f, 2.0f, 3.0f, 7.0f, 100.0f, 255.0f, 256.0f}) {
      num::NoiseOptions<float, N> options;
      options.period.emplace();
      options.period->fill(period);
      for (auto p : random_points<N>(50, -600.0f, 600.0f)) {
        // On a grid of 1/64, moving by a period is exact.
        for (float& x : p) x = std::round(x * 64) / 64;
        auto moved = p;
        moved[N - 1] += period;
        moved[0] -= 2 * period;
        EXPECT_EQ(kind.value(p, options), kind.value(moved, options))
            << kind.name << " " << N << "-D, " << period;
        if (period == 256.0f && kind.name != std::string("1985")) {
          EXPECT_EQ(kind.value(p, options), kind.value(p, {}));
        }
      }
    }
  }
}
TEST(NoiseStatistics, PeriodsHold) {
  periods_hold<1>();
  periods_hold<2>();
  periods_hold<3>();
  periods_hold<4>();
}

// Within a period the periodic noise is the plain one, and other periods are made whole.
TEST(NoiseStatistics, PeriodsKeepTheFirstTile) {
  num::NoiseOptions<float, 2> options{std::array{5.0f, 7.0f}, std::nullopt};
  EXPECT_EQ(num::improved_noise(std::array{3.3f, 5.6f}, options),
            num::improved_noise(std::array{3.3f, 5.6f}));
  const auto with = [](float period) {
    return num::improved_noise(std::array{300.3f, 0.4f},
                               num::NoiseOptions<float, 2>{std::array{period, period}, {}});
  };
  EXPECT_EQ(with(4.4f), with(4.0f));
  EXPECT_EQ(with(0.0f), with(256.0f));
  EXPECT_EQ(with(-3.0f), with(256.0f));
  EXPECT_EQ(with(1e9f), with(256.0f));
  EXPECT_EQ(with(std::nanf("")), with(256.0f));
}

// The last cell of a tile ends where the first begins.
TEST(NoiseStatistics, TilesJoin) {
  const float h = 0x1p-10f;
  for (const Kind<2>& kind : kinds<2>()) {
    for (const float period : {1.0f, 3.0f, 7.0f, 100.0f}) {
      const num::NoiseOptions<float, 2> options{std::array{period, period}, std::nullopt};
      for (const auto& p : random_points<2>(20)) {
        EXPECT_NEAR(kind.value({period - h, p[1]}, options),
                    kind.value({period + h, p[1]}, options), 8 * h);
        EXPECT_NEAR(kind.value({p[0], -h}, options), kind.value({p[0], h}, options), 8 * h);
      }
    }
  }
}

template <std::size_t N>
void derivatives_are_right() {
  for (const Kind<N>& kind : kinds<N>()) {
    for (const auto& p : random_points<N>(300, -4.0f, 4.0f)) {
      const auto slope = kind.gradient(p);
      for (std::size_t axis = 0; axis < N; ++axis) {
        const float step = 0x1p-8f;
        auto before = p, after = p;
        before[axis] -= step;
        after[axis] += step;
        // Across a face the second derivative may jump, and the difference is not central.
        if (std::floor(before[axis]) != std::floor(after[axis])) continue;
        const float difference =
            (kind.value(after, {}) - kind.value(before, {})) / (after[axis] - before[axis]);
        EXPECT_NEAR(slope[axis], difference, 2e-3) << kind.name << " " << N << "-D at " << p[0];
      }
    }
  }
}
TEST(NoiseStatistics, GradientsAreTheDifferences) {
  derivatives_are_right<1>();
  derivatives_are_right<2>();
  derivatives_are_right<3>();
  derivatives_are_right<4>();
}

// The book's listing adds 4096 to a position, so that it sees steps of 1/2048 at the finest.
TEST(NoiseStatistics, TheBooksGradientIsTheDifference) {
  const float step = 0x1p-7f;
  for (auto p : random_points<3>(300, -4.0f, 4.0f)) {
    for (float& x : p) x = std::round(x * 64) / 64;
    const auto slope = num::gradient(num::book_noise(num::variables(p)));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto before = p, after = p;
      before[axis] -= step;
      after[axis] += step;
      if (std::floor(before[axis]) != std::floor(after[axis])) continue;
      const float difference = (num::book_noise(after) - num::book_noise(before)) / (2 * step);
      EXPECT_NEAR(slope[axis], difference, 2e-3) << p[0] << " " << p[1] << " " << p[2];
    }
  }
}

// Across the faces of cells value and gradient are continuous; with the quintic fade the gradient's
// slope is as well.
template <std::size_t N>
void cells_join() {
  const float h = 0x1p-10f;
  for (const Kind<N>& kind : kinds<N>()) {
    for (auto p : random_points<N>(100, -20.0f, 20.0f)) {
      for (std::size_t axis = 0; axis < N; ++axis) {
        auto at = p, below = p, above = p;
        at[axis] = std::round(p[axis]);
        below[axis] = at[axis] - h;
        above[axis] = at[axis] + h;
        EXPECT_NEAR(kind.value(below, {}), kind.value(above, {}), 8 * h) << kind.name;
        const auto left = kind.gradient(below), middle = kind.gradient(at),
                   right = kind.gradient(above);
        for (std::size_t k = 0; k < N; ++k) {
          EXPECT_NEAR(left[k], right[k], 60 * h) << kind.name;
          if (kind.second_derivative) {
            EXPECT_NEAR(middle[k] - left[k], right[k] - middle[k], 0.5 * h) << kind.name;
          }
        }
      }
    }
  }
}
TEST(NoiseStatistics, CellsJoinSmoothly) {
  cells_join<1>();
  cells_join<2>();
  cells_join<3>();
  cells_join<4>();
}

}  // namespace
}  // namespace pse::test
