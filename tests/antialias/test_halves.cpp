// Means of samples half a pixel apart: their answers to waves in closed form, where they are taken,
// and pictures of what changes within a pixel.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "antialias/half_grid.h"
#include "antialias/steps.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr double pi = std::numbers::pi;

// To the wave (s, t), in radians per pixel.
double answer(const HalfWeights& by, double s, double t) {
  return by.middle + 2 * by.side * (std::cos(s / 2) + std::cos(t / 2)) +
         4 * by.corner * std::cos(s / 2) * std::cos(t / 2) +
         2 * by.next * (std::cos(s) + std::cos(t));
}

// Of the chapter's kernel, whose projection is 6 (1/4 - a^2): 12 (sin h - h cos h) / (h^2 f), h = f
// / 2.
double answer_of_cubic(double f) {
  const double h = f / 2;
  return 3 * (std::sin(h) - h * std::cos(h)) / (h * h * h);
}
double answer_of_box(double s, double t) {
  return std::sin(s / 2) / (s / 2) * (std::sin(t / 2) / (t / 2));
}

TEST(Halves, AnswerWavesAsTheKernelDoes) {
  for (const FilterKind kind : {FilterKind::cubic, FilterKind::box}) {
    const auto means = half_means_of(Filter(kind));
    ASSERT_TRUE(means);
    for (const HalfWeights& by : {means->with_next, means->alone}) {
      EXPECT_NEAR(answer(by, 0, 0), 1, 1e-6);
      EXPECT_NEAR(by.side / 2 + by.corner + 2 * by.next, Filter(kind).variance(), 1e-6);
    }
    for (const double pixels : {1.5, 1.6, 2.0, 3.0, 5.0})
      for (const double degrees : {0.1, 15.0, 30.0, 45.0}) {
        const double f = 2 * pi / pixels, angle = degrees * pi / 180;
        const double s = f * std::cos(angle), t = f * std::sin(angle);
        const double exact = kind == FilterKind::cubic ? answer_of_cubic(f) : answer_of_box(s, t);
        // The nine samples of smooth.h are off by up to 0.5 here.
        EXPECT_NEAR(answer(means->with_next, s, t), exact, pixels > 1.55 ? 0.006 : 0.012)
            << int(kind) << ' ' << pixels << ' ' << degrees;
        EXPECT_NEAR(answer(means->alone, s, t), exact, pixels > 1.9 ? 0.035 : 0.09)
            << int(kind) << ' ' << pixels << ' ' << degrees;
      }
    const double f = 2 * pi / 1.6;
    const double along = kind == FilterKind::cubic ? answer_of_cubic(f) : answer_of_box(f, 1e-9);
    EXPECT_NEAR(answer(means->with_next, f, 0), along, 2e-4);
  }
  for (const FilterKind wide :
       {FilterKind::disc, FilterKind::cone, FilterKind::paraboloid, FilterKind::gauss})
    EXPECT_FALSE(half_means_of(Filter(wide)));
}

TEST(Halves, EachSampleIsTakenOnceWhereItIsWanted) {
  const Rect rect{10, 20, 37, 31};
  std::vector<Pixel> pixels;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      if ((x * 7 + y * 13) % 11 < 2 || (x == 36 && y == 30) || (x == 10 && y == 20))
        pixels.push_back({.x = x, .y = y});
  HalfGrid grid;
  grid.begin(rect, pixels, 2);
  std::set<std::pair<double, double>> places;
  std::size_t count = 0;
  for (const HalfGrid::Run& run : grid.runs()) {
    std::vector<double> x(static_cast<std::size_t>(run.count)), y(x.size());
    grid.places(run, x.data(), y.data());
    for (std::size_t i = 0; i < x.size(); ++i, ++count) {
      places.emplace(x[i], y[i]);
      // Where its value goes.
      *grid.at(run.kind, 1, run.x + static_cast<int>(i), run.y) =
          static_cast<float>(1000 * x[i] + y[i]);
    }
  }
  EXPECT_EQ(places.size(), count);
  for (const Pixel& pixel : pixels) {
    const int x = pixel.x - rect.x0, y = pixel.y - rect.y0;
    const auto is_at = [&](Half kind, int right, int up, double px, double py) {
      EXPECT_TRUE(places.contains({px, py})) << px << ' ' << py;
      EXPECT_EQ(*grid.at(kind, 1, x + right, y + up), static_cast<float>(1000 * px + py));
    };
    for (const int k : {0, 1}) {
      is_at(Half::beside, k, 0, pixel.x + k, pixel.y + 0.5);
      is_at(Half::below, 0, k, pixel.x + 0.5, pixel.y + k);
      for (const int l : {0, 1}) is_at(Half::corner, k, l, pixel.x + k, pixel.y + l);
    }
  }

  // All of them want three each and those of one more row and column.
  pixels.clear();
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) pixels.push_back({.x = x, .y = y});
  grid.begin({0, 0, 9, 5}, pixels, 1);
  count = 0;
  for (const HalfGrid::Run& run : grid.runs()) count += static_cast<std::size_t>(run.count);
  EXPECT_EQ(count, 10u * 5 + 9 * 6 + 10 * 6);
  // One alone wants eight.
  grid.begin({0, 0, 9, 5}, std::span(pixels).subspan(20, 1), 1);
  count = 0;
  for (const HalfGrid::Run& run : grid.runs()) count += static_cast<std::size_t>(run.count);
  EXPECT_EQ(count, 8u);
}

double error(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.planes[0].size(); ++i)
    sum += std::pow(double(a.planes[0][i]) - b.planes[0][i], 2.0);
  return std::sqrt(sum / static_cast<double>(a.planes[0].size()));
}

constexpr const char* zone_plate = "c = 0.5 + 0.5 * sin(40 * (x * x + y * y))\n";

TEST(Halves, AreSeveralTimesNearerThan16Samples) {
  for (const char* program :
       {zone_plate, "c = Noise(px / 2, py / 2, 0.4)\n", "c = Noise(px / 1.5, py / 1.5, 0.4)\n",
        "c = sin(2 * PI * (0.8 * px + 0.6 * py) / 2)\n"}) {
    const auto with = [&](const Options& options) {
      return render(program, {.width = 64, .height = 64, .antialias = options});
    };
    const Picture truth = with(samples(1024)), ours = with(procedural());
    EXPECT_LT(error(ours, truth), 0.6 * error(with(samples(16)), truth)) << program;
    EXPECT_GT(ours.counts.supersampled, 64 * 64 / 2) << program;
  }
}

TEST(Halves, TheSameBitsHoweverTheyAreRun) {
  for (const std::string& program :
       {std::string(zone_plate),
        std::string("c = Noise(px / 1.7, py / 1.7)\nif c > 0.1\n    c = 1 - c\n")})
    expect_same_bits(program);
}

TEST(Halves, EvenOutputsKeepTheirBits) {
  const std::string program =
      "c = Noise(px / 2, py / 2)\nd = 0.3 * x - 0.7 * y\ne = floor(px) % 2\n";
  const Picture ours = render(program, {.antialias = procedural()});
  const Picture none = render(program, {.antialias = plain()});
  EXPECT_GT(ours.counts.supersampled, 32 * 32 / 2);
  EXPECT_NE(ours.plane(), none.plane());
  for (const char* name : {"d", "e"}) EXPECT_EQ(ours.plane(name), none.plane(name)) << name;
}

// A single sample of a spark weighs less than nothing where it lies in the next pixel.
TEST(Halves, NoLightIsTakenAway) {
  const Picture picture = render(
      "c = 0.1 + 0.05 * Noise(px / 2, py / 2)\nc += 1000 * exp(-40 * ((px - 9.5) ^ 2 + (py - 8.5) "
      "^ "
      "2))\n",
      {.antialias = procedural()});
  EXPECT_GT(picture.counts.supersampled, 0);
  for (const float value : picture.plane()) EXPECT_GE(value, 0);
}

TEST(Halves, WhatIsNoNumberLeavesThePixel) {
  const Picture picture =
      render("c = Noise(px / 2, py / 2)\nif px == 9 and py < 20\n    c = 0 / 0\n",
             {.antialias = procedural()});
  for (const float value : picture.plane()) EXPECT_FALSE(std::isnan(value));
}

}  // namespace
}  // namespace pse::antialias::test
