// Where the energy of the noise functions lies: their power spectra, measured by Fourier transforms
// of periodic noise and held against closed forms. A noise is a sum of wavelets, one for each
// lattice point and axis, with weights that have nothing to do with each other; so the spectrum is
// the sum of the wavelets' own. Frequencies are in cycles per lattice cell.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "noise/seed.h"
#include "noise/tables.h"

namespace pse::test {
namespace {

// ---- What a noise is made of ----

// The weight w(t) of a lattice point along an axis, on [-1, 1], and the integrals that closed forms
// need of it. By hand: the integrals of polynomials.
struct Weight {
  double (*at)(double);
  double square;        // of w^2
  double second;        // of t^2 w^2
  double slope_square;  // of w'^2
  double second_slope;  // of ((t w)')^2
};
double quintic_weight(double t) {
  const double x = std::fabs(t);
  return 1 - x * x * x * (10 - x * (15 - 6 * x));
}
double cubic_weight(double t) {
  const double x = std::fabs(t);
  return 1 - x * x * (3 - 2 * x);
}
const Weight quintic{quintic_weight, 181.0 / 231, 535.0 / 9009, 20.0 / 7, 60.0 / 77};
const Weight cubic{cubic_weight, 26.0 / 35, 19.0 / 315, 12.0 / 5, 24.0 / 35};

template <std::size_t N>
struct Kind {
  std::string name;
  Weight weight;
  double value = 0;               // mean square of a lattice point's value
  std::array<double, N> slope{};  // and of each component of its gradient
  std::function<float(const std::array<float, N>&, const num::NoiseOptions<float, N>&)> at;
  std::function<std::array<float, N>(const std::array<float, N>&,
                                     const num::NoiseOptions<float, N>&)>
      gradient;
};

double mean_square(const num::FloatTable& table) {
  double sum = 0;
  for (const float x : table.entries) sum += double{x} * double{x};
  return sum / static_cast<double>(table.entries.size());
}

template <std::size_t N>
std::vector<Kind<N>> kinds() {
  std::array<double, N> of_2002{}, of_1989{}, of_1985{};
  for (std::size_t k = 0; k < N; ++k) {
    of_2002[k] = mean_square(num::gradient_tables(N)[k]);
    of_1989[k] = mean_square(num::sphere_tables(N)[k]);
    of_1985[k] = 1.0 / 3;  // uniform in [-1, 1]
  }
  const auto slopes = [](const auto& noise) {
    return [noise](const std::array<float, N>& p, const num::NoiseOptions<float, N>& options) {
      return num::gradient(noise(num::variables(p), options));
    };
  };
  const auto n2002 = [](const auto& p, const auto& o) { return num::improved_noise(p, o); };
  const auto n1989 = [](const auto& p, const auto& o) { return num::noise_1989(p, o); };
  const auto n1985 = [](const auto& p, const auto& o) { return num::noise_1985(p, o); };
  return {{"2002", quintic, 0, of_2002, n2002, slopes(n2002)},
          {"1989", cubic, 0, of_1989, n1989, slopes(n1989)},
          {"1985", cubic, 1.0 / 3, of_1985, n1985, slopes(n1985)}};
}

// ---- Mean squares ----

template <std::size_t N>
double variance(const Kind<N>& kind) {
  const Weight& w = kind.weight;
  double sum = kind.value * std::pow(w.square, N);
  for (const double slope : kind.slope) sum += slope * w.second * std::pow(w.square, N - 1);
  return sum;
}

// Of the derivative along an axis.
template <std::size_t N>
double derivative_energy(const Kind<N>& kind, std::size_t axis) {
  const Weight& w = kind.weight;
  double sum = kind.value * w.slope_square * std::pow(w.square, N - 1);
  for (std::size_t k = 0; k < N; ++k)
    sum += kind.slope[k] * (k == axis ? w.second_slope * std::pow(w.square, N - 1)
                                      : w.second * w.slope_square * std::pow(w.square, N - 2.0));
  return sum;
}

// The mean of one number per seed, and how far from the truth it may be: five of its standard
// errors.
struct Mean {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double value) { sum += value, squares += value * value, ++count; }
  double value() const { return sum / count; }
  double allowance() const {
    return 5 * std::sqrt((squares / count - value() * value()) / (count - 1));
  }
};

// On a line a seed puts the same 256 gradients, whose sum is nearly 0, into another order. Two
// neighbours are never the same entry, so their product is on average not 0 but -1/255 of the mean
// square; the integral of w(f) w(1 - f) f (1 - f) is 0.82 (quintic) or 0.92 (cubic) of that of
// f^2 w^2, so the noise's mean square is at most 1/255 more than that of independent gradients.
constexpr double of_order = 1.0 / 255;

// Over many seeds, so that the few gradients of one lattice do not count.
template <std::size_t N>
void mean_squares_are_closed_forms() {
  for (const Kind<N>& kind : kinds<N>()) {
    SCOPED_TRACE(kind.name + " " + std::to_string(N) + "-D");
    std::mt19937 random(N);
    std::uniform_real_distribution<float> coordinate(0.0f, 256.0f);
    constexpr int seeds = 1000, points = 100;
    Mean square, along;
    std::array<Mean, N> energy{};
    for (int seed = 0; seed < seeds; ++seed) {
      const num::NoiseOptions<float, N> options{std::nullopt,
                                                num::key_of_seed(static_cast<float>(seed))};
      double squares = 0, products = 0;
      std::array<double, N> slopes{};
      for (int i = 0; i < points; ++i) {
        std::array<float, N> p;
        for (float& x : p) x = coordinate(random);
        const double value = kind.at(p, options);
        squares += value * value;
        const auto slope = kind.gradient(p, options);
        for (std::size_t k = 0; k < N; ++k) slopes[k] += double{slope[k]} * double{slope[k]};
        // Two cells on along an axis nothing is left of the wavelets.
        auto far = p;
        far[seed % N] += 2.0f + 0.01f * static_cast<float>(i);
        products += value * double{kind.at(far, options)};
      }
      square.add(squares / points / variance(kind));
      along.add(products / points / variance(kind));
      for (std::size_t k = 0; k < N; ++k)
        energy[k].add(slopes[k] / points / derivative_energy(kind, k));
    }
    const auto expect = [](const Mean& mean, double closed) {
      EXPECT_NEAR(mean.value(), closed, mean.allowance() + (N == 1 ? of_order : 0));
      EXPECT_LT(mean.allowance(), 0.03);
    };
    expect(square, 1);
    expect(along, 0);
    for (const Mean& mean : energy) expect(mean, 1);
  }
}
TEST(NoiseSpectrum, MeanSquaresAreTheClosedFormsInAllDimensions) {
  mean_squares_are_closed_forms<1>();
  mean_squares_are_closed_forms<2>();
  mean_squares_are_closed_forms<3>();
  mean_squares_are_closed_forms<4>();
}

// The closed forms against the published fractions.
TEST(NoiseSpectrum, ClosedFormsAreThePublishedNumbers) {
  const auto three = kinds<3>();
  EXPECT_NEAR(variance(three[0]), 35054270.0 / 480729249, 1e-9);
  EXPECT_NEAR(variance(three[0]) / 2, 17527135.0 / 480729249, 1e-9);  // for gradients of length 1
  EXPECT_NEAR(variance(three[1]), 12844.0 / 385875, 1e-9);
  EXPECT_NEAR(variance(three[1]) * 1.5 * 1.5, 3211.0 / 42875, 1e-9);  // the listing's factor
  EXPECT_NEAR(variance(kinds<2>()[0]) / 2, 96835.0 / 2081079, 1e-9);
  EXPECT_NEAR(derivative_energy(three[0], 0), 77205550.0 / 160243083, 1e-9);
  EXPECT_NEAR(derivative_energy(three[0], 1), 84125180.0 / 160243083, 1e-9);
  EXPECT_NEAR(derivative_energy(three[0], 2), 77205550.0 / 160243083, 1e-9);
}

// ---- Spectra ----

using Complex = std::complex<double>;

// The Fourier transform of a row whose length is a power of two, in place.
void transform(std::vector<Complex>& row) {
  const std::size_t n = row.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(row[i], row[j]);
  }
  for (std::size_t length = 2; length <= n; length *= 2) {
    const double angle = -2 * std::numbers::pi / static_cast<double>(length);
    for (std::size_t k = 0; k < length / 2; ++k) {
      const Complex turn = std::polar(1.0, angle * static_cast<double>(k));
      for (std::size_t i = k; i < n; i += length) {
        const Complex odd = turn * row[i + length / 2];
        row[i + length / 2] = row[i] - odd;
        row[i] += odd;
      }
    }
  }
}

// Energy by distance from frequency 0, in shells of width 1 / period; the last holds what is beyond
// the highest frequency sampled. `density` is the mean over a shell.
struct Shells {
  double width = 0;
  std::vector<double> energy, count;
  double total = 0;

  // The part of the energy with frequencies in [low, high).
  double fraction(double low, double high) const {
    double sum = 0;
    for (std::size_t i = 0; i < energy.size(); ++i) {
      const double f = static_cast<double>(i) * width;
      if (f >= low && f < high) sum += energy[i];
    }
    return sum / total;
  }
};

// `energy_at(f)` for each frequency vector of a grid of `samples` on each side, by the index of the
// grid's point.
template <std::size_t N, class Energy>
Shells shells(int period, int samples, const Energy& energy_at) {
  Shells result;
  result.width = 1.0 / period;
  result.energy.assign(static_cast<std::size_t>(2 * samples), 0);
  result.count = result.energy;
  std::size_t points = 1;
  for (std::size_t k = 0; k < N; ++k) points *= static_cast<std::size_t>(samples);
  for (std::size_t at = 0; at < points; ++at) {
    std::array<double, N> f;
    double square = 0;
    std::size_t rest = at;
    for (std::size_t k = 0; k < N; ++k) {
      const int i = static_cast<int>(rest % static_cast<std::size_t>(samples));
      rest /= static_cast<std::size_t>(samples);
      f[k] = static_cast<double>(i < samples / 2 ? i : i - samples) / period;
      square += f[k] * f[k];
    }
    const auto shell = static_cast<std::size_t>(std::sqrt(square) * period + 1e-9);
    const double energy = energy_at(f, at);
    result.energy[shell] += energy;
    result.count[shell] += 1;
    result.total += energy;
  }
  return result;
}

// Periodic noise, sampled and transformed.
template <std::size_t N>
Shells measured(const Kind<N>& kind, int period, int samples, float seed) {
  num::NoiseOptions<float, N> options;
  options.key = num::key_of_seed(seed);
  options.period.emplace();
  options.period->fill(static_cast<float>(period));
  const auto side = static_cast<std::size_t>(samples);
  std::size_t points = 1;
  for (std::size_t k = 0; k < N; ++k) points *= side;
  std::vector<Complex> values(points);
  for (std::size_t at = 0; at < points; ++at) {
    std::array<float, N> p;
    std::size_t rest = at;
    for (float& x : p) {
      x = static_cast<float>(rest % side) * static_cast<float>(period) /
          static_cast<float>(samples);
      rest /= side;
    }
    values[at] = kind.at(p, options);
  }
  std::vector<Complex> row(side);
  for (std::size_t step = 1; step < points; step *= side)
    for (std::size_t at = 0; at < points; ++at) {
      if (at / step % side != 0) continue;
      for (std::size_t i = 0; i < side; ++i) row[i] = values[at + i * step];
      transform(row);
      for (std::size_t i = 0; i < side; ++i) values[at + i * step] = row[i];
    }
  return shells<N>(period, samples,
                   [&](const auto&, std::size_t at) { return std::norm(values[at]); });
}

// The wavelets' transforms: of w(t), which is even, and t w(t), which is odd.
double wavelet(const Weight& weight, double f, bool odd) {
  constexpr int steps = 400;  // Simpson's rule on [0, 1]
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps, phase = 2 * std::numbers::pi * f * t;
    const double value = weight.at(t) * (odd ? t * std::sin(phase) : std::cos(phase));
    sum += value * (i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2);
  }
  return 2 * sum / (3 * steps);
}

template <std::size_t N>
Shells expected(const Kind<N>& kind, int period, int samples) {
  // Squares of the transforms at the grid's frequencies.
  std::vector<double> even, odd;
  for (int i = 0; i <= samples / 2; ++i) {
    const double f = static_cast<double>(i) / period;
    even.push_back(std::pow(wavelet(kind.weight, f, false), 2));
    odd.push_back(std::pow(wavelet(kind.weight, f, true), 2));
  }
  return shells<N>(period, samples, [&](const std::array<double, N>& f, std::size_t) {
    const auto index = [&](std::size_t k) {
      return static_cast<std::size_t>(std::lround(std::fabs(f[k]) * period));
    };
    double all_even = 1, sum = 0;
    for (std::size_t k = 0; k < N; ++k) all_even *= even[index(k)];
    for (std::size_t k = 0; k < N; ++k) {
      double product = kind.slope[k] * odd[index(k)];
      for (std::size_t j = 0; j < N; ++j)
        if (j != k) product *= even[index(j)];
      sum += product;
    }
    return kind.value * all_even + sum;
  });
}

// The frequency at which `curve`, a value for each shell, is largest.
double peak(const Shells& shells, const std::function<double(std::size_t)>& curve) {
  std::size_t best = 1;
  for (std::size_t i = 1; i < shells.energy.size(); ++i)
    if (shells.count[i] > 0 && curve(i) > curve(best)) best = i;
  return (static_cast<double>(best) + 0.5) * shells.width;
}

// The published fractions and peaks of the 2002 noise in three dimensions, first of the closed form
// on a fine grid of frequencies, then of the noise itself.
TEST(NoiseSpectrum, TheImprovedNoiseLiesAroundOneCyclePerCell) {
  const Kind<3> improved = kinds<3>()[0];
  const auto density = [](const Shells& s) {
    return [&s](std::size_t i) { return s.energy[i] / s.count[i]; };
  };
  const auto energy = [](const Shells& s) { return [&s](std::size_t i) { return s.energy[i]; }; };

  const Shells closed = expected(improved, 32, 128);
  EXPECT_NEAR(closed.fraction(0, 0.25), 0.010471390317838416, 0.0006);
  EXPECT_NEAR(closed.fraction(0, 0.5), 0.19577184966537184, 0.002);
  EXPECT_NEAR(closed.fraction(0.5, 1), 0.7355702312007522, 0.004);
  EXPECT_NEAR(closed.fraction(1, 100), 0.06865791913387598, 0.002);
  EXPECT_NEAR(peak(closed, density(closed)), 0.48, 0.04);
  EXPECT_NEAR(peak(closed, energy(closed)), 0.665, 0.04);

  const Shells found = measured(improved, 32, 128, 5);
  EXPECT_NEAR(found.fraction(0, 0.25) / 0.010471390317838416, 1, 0.12);
  EXPECT_NEAR(found.fraction(0, 0.5) / 0.19577184966537184, 1, 0.04);
  EXPECT_NEAR(found.fraction(0.5, 1) / 0.7355702312007522, 1, 0.02);
  EXPECT_NEAR(found.fraction(1, 100) / 0.06865791913387598, 1, 0.04);
  EXPECT_NEAR(peak(found, density(found)), 0.48, 0.1);
  EXPECT_NEAR(peak(found, energy(found)), 0.665, 0.1);

  // Above two cycles there is next to nothing; this takes twice the samples in a cell.
  const Shells fine = measured(improved, 16, 128, 5);
  EXPECT_NEAR(fine.fraction(2, 100) / 0.0001645429540035881, 1, 0.12);
}

// Every kind in every dimension has the spectrum of its wavelets.
template <std::size_t N>
void spectra_are_closed_forms(int period, int samples, double tolerance) {
  for (const Kind<N>& kind : kinds<N>()) {
    SCOPED_TRACE(kind.name + " " + std::to_string(N) + "-D");
    const Shells closed = expected(kind, period, samples);
    const double highest = samples / 2.0 / period;
    const std::array<double, 6> edges = {0, 0.25, 0.5, 1, highest, 100};
    std::array<double, 5> sums{};
    constexpr int seeds = N == 1 ? 100 : N == 2 ? 8 : 1;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Shells found = measured(kind, period, samples, static_cast<float>(seed));
      for (std::size_t i = 0; i + 1 < edges.size(); ++i)
        sums[i] += found.fraction(edges[i], edges[i + 1]) / seeds;
    }
    for (std::size_t i = 0; i < sums.size(); ++i)
      EXPECT_NEAR(sums[i], closed.fraction(edges[i], edges[i + 1]), tolerance) << edges[i];
  }
}
TEST(NoiseSpectrum, EveryKindHasTheSpectrumOfItsWavelets) {
  spectra_are_closed_forms<1>(128, 1024, 0.02);
  spectra_are_closed_forms<2>(64, 512, 0.01);
  spectra_are_closed_forms<3>(16, 64, 0.02);
  spectra_are_closed_forms<4>(8, 32, 0.03);
}

}  // namespace
}  // namespace pse::test
