// What bends between edges is smoothed by its neighbours to its mean under the kernel: waves and
// parabolas against closed forms, and what must stay as it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "antialias/smooth.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr std::array kinds = {FilterKind::cubic, FilterKind::box,        FilterKind::disc,
                              FilterKind::cone,  FilterKind::paraboloid, FilterKind::gauss};

// The kernel's answer to a wave, summed up over places of equal weight.
double answer(const Filter& filter, double s, double t) {
  constexpr int places = 256;
  double sum = 0;
  for (int i = 0; i < places; ++i)
    for (int k = 0; k < places; ++k) {
      const auto [x, y] = filter.place((static_cast<float>(i) + 0.5f) / places,
                                       (static_cast<float>(k) + 0.5f) / places);
      sum += std::cos(s * double(x) + t * double(y));
    }
  return sum / (double(places) * places);
}
double answer(const Smoothing& by, double s, double t) {
  return 1 + 2 * double(by.axis) * (std::cos(s) + std::cos(t) - 2) +
         4 * double(by.diagonal) * (std::cos(s) * std::cos(t) - 1);
}

TEST(Smooth, AnswersWavesAsTheKernelDoes) {
  for (const FilterKind kind : kinds) {
    const Filter filter(kind);
    const Smoothing by = smoothing_of(filter);
    EXPECT_NEAR(by.axis + 2 * by.diagonal, filter.variance() / 2, 1e-6);
    double worst_wide = 0, worst = 0;
    for (const double degrees : {0.0, 15.0, 30.0, 45.0, 70.0}) {
      const double angle = degrees * std::numbers::pi / 180;
      const auto apart = [&](double pixels) {
        const double s = 2 * std::numbers::pi / pixels * std::cos(angle),
                     t = 2 * std::numbers::pi / pixels * std::sin(angle);
        return std::abs(answer(by, s, t) - answer(filter, s, t));
      };
      worst_wide = std::max(worst_wide, apart(10));
      worst = std::max(worst, apart(4));
    }
    // Off by 0.01 to 0.05 and by 0.06 to 0.25 without any smoothing.
    EXPECT_LT(worst_wide, 0.001) << int(kind);
    EXPECT_LT(worst, 0.03) << int(kind);
  }
}

// Of a kernel wider than nine samples reach there is no wave that is turned round.
TEST(Smooth, WideKernelsAreStable) {
  for (const FilterKind kind : kinds)
    for (const float scale : {0.25f, 1.5f, 4.0f}) {
      const Smoothing by = smoothing_of(Filter(kind, scale));
      for (double s = 0; s < 3.15; s += 0.314)
        for (double t = 0; t < 3.15; t += 0.314) {
          EXPECT_LT(answer(by, s, t), 1.0001);
          EXPECT_GT(answer(by, s, t), -0.15) << int(kind) << ' ' << scale;
        }
    }
}

// Pixels are 1/16 wide here.
TEST(Smooth, ParabolasAreExact) {
  for (const FilterKind kind : kinds) {
    const Picture picture = render("c = x * x + x * y\nd = y ^ 3\n",
                                   {.interpret = true, .antialias = procedural(kind)});
    const double moment = double(Filter(kind).variance()) / 256;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const double px = (x + 0.5) / 16 - 1, py = 1 - (y + 0.5) / 16;
        EXPECT_NEAR(picture.at(x, y), px * px + px * py + moment, 1e-6);
        EXPECT_NEAR(picture.at(x, y, "d"), py * py * py + 3 * py * moment, 1e-6);
      }
    EXPECT_EQ(picture.counts.supersampled, 0);
  }
}

double error(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.planes[0].size(); ++i) {
    const double apart = double(a.planes[0][i]) - b.planes[0][i];
    sum += apart * apart;
  }
  return std::sqrt(sum / static_cast<double>(a.planes[0].size()));
}

TEST(Smooth, NearerThan16Samples) {
  for (const char* program :
       {"c = Noise(px / 4 + 0.37, py / 4 + 0.11, 0.4)\n",
        "c = sin(2 * PI * (0.8 * px + 0.6 * py) / 3)\n", "c = sin(2 * PI * px / 5)\n",
        "c = exp(-((px - 9) ^ 2 + (py - 8) ^ 2) / 4)\n",
        // In the branch of a conditional, and beside its edge.
        "c = Noise(px / 4, py / 4, 0.4)\nif px + 0.3 * py > 20\n    c = 1 + Noise(py / 4, 0.2)\n"})
    for (const FilterKind kind : {FilterKind::cubic, FilterKind::gauss}) {
      const Picture truth = render(program, {.antialias = samples(1024, kind)});
      const double ours = error(render(program, {.antialias = procedural(kind)}), truth);
      EXPECT_LT(ours, error(render(program, {.antialias = samples(16, kind)}), truth)) << program;
      EXPECT_LT(ours, 0.5 * error(render(program, {.antialias = plain()}), truth)) << program;
    }
}

TEST(Smooth, TheSameBitsHoweverItIsRun) {
  for (const char* program : {"c = Noise(px / 3, py / 3)\n",
                              "c = Noise(px / 3, py / 3)\nif c > 0.1\n    c = y * y - c\n"})
    expect_same_bits(program);
}

TEST(Smooth, WhatIsEvenKeepsItsBits) {
  for (const char* program :
       {"c = 0.3 * x - 0.7 * y + 1 / 3\n", "c = 0.1\n", "c = px / width + time\n",
        "c = y\nfor i in [1 .. 3]\n    c += x / 3\n", "c = point.x + 2 * point.y\n",
        "c = hash(floor(3 * x), floor(3 * y) + 0.5)\n", "c = (x > 0.3 ? 2 : 3) * y\n"}) {
    const Picture none = render(program, {.antialias = plain()});
    const Picture ours = render(program, {.antialias = procedural()});
    int same = 0;
    for (std::size_t i = 0; i < none.planes[0].size(); ++i)
      same += none.planes[0][i] == ours.planes[0][i] ? 1 : 0;
    EXPECT_GE(same, 32 * 32 - ours.counts.blended - ours.counts.supersampled) << program;
  }
}

// Whole numbers of pixels are the pixels' own, even in what bends; a hash is chance, and its mean
// is kept.
TEST(Smooth, PatternsOfPixelsStay) {
  for (const char* program :
       {"c = (floor(px) % 2) * x * x\n", "c = x * x + hash(floor(px), 3)\n"}) {
    const Picture none = render(program, {.antialias = plain()});
    EXPECT_EQ(render(program, {.antialias = procedural()}).planes, none.planes) << program;
  }
  double sum = 0;
  const Picture chance = render("c = hash(px, py)\n", {.antialias = procedural()});
  for (const float value : chance.plane()) sum += double(value) / 1024;
  EXPECT_NEAR(sum, 0.5, 0.03);
}

// Far from an edge, which lies midway between pixels 16 and 17, a picture of two parabolas is as
// either alone; beside it nothing is told by the bends across it.
TEST(Smooth, OnlyNeighboursOfTheSameWayCount) {
  const Picture picture =
      render("c = x * x\nif x > 0.0625\n    c += 100\n", {.antialias = procedural()});
  const Picture alone = render("c = x * x\n", {.antialias = procedural()});
  const Picture none = render("c = x * x\n", {.antialias = plain()});
  for (int x = 0; x < 32; ++x) {
    const bool is_beside = x == 16 || x == 17;
    EXPECT_NEAR(picture.at(x, 9) - (x > 16 ? 100.0f : 0.0f), (is_beside ? none : alone).at(x, 9),
                1e-5)
        << x;
  }
}

// A dot of light narrower than a pixel: the weights of corners are below 0.
TEST(Smooth, NoLightIsTakenAway) {
  const Picture picture = render("d = [px py] - [8.5 8.5]\nc = 1000 * exp(-40 * dot(d, d))\n",
                                 {.width = 16, .height = 16, .antialias = procedural()});
  for (const float value : picture.plane()) EXPECT_GE(value, 0);
  EXPECT_LT(std::ranges::max(picture.plane()), 900);
}

TEST(Smooth, WhatIsNoNumberStays) {
  const std::string program = "c = sqrt(x) / (y < 0 ? 0 : 1)\n";
  const Picture none = render(program, {.antialias = plain()});
  const Picture ours = render(program, {.antialias = procedural()});
  int strange = 0;
  for (std::size_t i = 0; i < none.planes[0].size(); ++i) {
    if (std::isfinite(none.planes[0][i])) {
      EXPECT_TRUE(std::isfinite(ours.planes[0][i])) << i;
    } else {
      ++strange;
    }
  }
  EXPECT_GT(strange, 200);
}

// What is looked up in a stored picture is that picture's.
TEST(Smooth, StoredPicturesAreLeftAlone) {
  CompileOptions options;
  options.lower.stream = image_plane_names();
  LowerHost host;
  host.texture_components = [](const std::string&, const std::string&, std::string&) { return 1; };
  SourceMap sources;
  Diagnostics diagnostics;
  const std::string text =
      "a = texture(\"wood.exr\", u, v)\nb = x * x * y\nc = b + 0.1 * a\nd = x + 2 * y\n";
  auto front = compile_front(sources, sources.add("test.pse", text), host, options, diagnostics);
  ASSERT_TRUE(front) << print_text(diagnostics, sources, false);
  const InputChanges changes = image_plane_changes(std::nullopt);
  const auto programs = compile_programs(std::move(*front), {}, Mode::procedural, changes);
  ASSERT_TRUE(programs);
  using enum Course;
  EXPECT_EQ(programs->courses, (std::vector<Course>{fixed, bent, fixed, even}));
}

}  // namespace
}  // namespace pse::antialias::test
