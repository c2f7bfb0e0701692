// Noise that changes within a pixel is sampled, wherever it stands, and noise that does not is left
// alone. In these pictures of 32 x 32 pixels x and y change by 1/16 from pixel to pixel, so that
// the place of Noise(k * x) moves by k / 16, and noise is looked at from k = 16 * 0.3 = 4.8 on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "antialias/decisions.h"
#include "antialias/smooth.h"
#include "passes/passes.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr int pixels = 32 * 32;

std::int64_t sampled(const std::string& program) {
  const Picture picture = render(program, {.interpret = true, .antialias = procedural()});
  EXPECT_EQ(picture.counts.blended, 0) << program;
  return picture.counts.supersampled;
}

TEST(Fine, FromThreeTenthsOfACellPerPixelOn) {
  constexpr double most = 0.75 * pixels;
  EXPECT_EQ(sampled("c = Noise(4.79 * x, 0.3)\n"), 0);
  EXPECT_GT(sampled("c = Noise(4.81 * x, 0.3)\n"), most);
  EXPECT_EQ(sampled("c = Noise(0.3, 4.79 * y)\n"), 0);
  EXPECT_GT(sampled("c = Noise(0.3, 4.81 * y)\n"), most);
  // Along a row both coordinates change, by sqrt(2) k / 16 together.
  EXPECT_EQ(sampled("c = Noise(3.39 * (x + y), 3.39 * (x - y))\n"), 0);
  EXPECT_GT(sampled("c = Noise(3.41 * (x + y), 3.41 * (x - y))\n"), most);
  // A wave's period is 1.3 cells: from 16 * 0.3 / 1.3 = 3.69 on.
  EXPECT_EQ(sampled("c = sin(TAU * 3.68 * x + y)\n"), 0);
  EXPECT_GT(sampled("c = sin(TAU * 3.71 * x + y)\n"), 0.8 * pixels);
  EXPECT_GT(sampled("c = cos(TAU * 3.71 * y)\n"), 0.8 * pixels);
}

TEST(Fine, OfEveryKindAndFromEveryPlace) {
  for (const char* program :
       {"c = unoise(40 * x, 40 * y)\n", "c = noise(40 * point)\n", "c = vnoise(40 * point).y\n",
        "c = noise1985(40 * x, 40 * y)\n", "c = noise1989(40 * x, 40 * y)\n",
        "c = book_noise(40 * point)\n", "c = Dnoise([40 * x 40 * y]).x\n",
        "c = pnoise(40 * x, 40 * y, 64)\n", "c = Noise(40 * x, 40 * y, seed = 3)\n",
        "function f(p)\n    return Noise(8 * p)\nc = f([5 * x 5 * y])\n",
        "c = 0\nfor i in [1 .. 6]\n    c += Noise(2 ^ i * x, 2 ^ i * y)\n",
        "c = 0\nf = 1\nq = [x y]\nfor i in [1 .. 40]\n    c += Noise(f * q) / 8\n    f += 1\n",
        "c = fbm(10 * [x y], 4)\n"})
    EXPECT_GT(sampled(program), 0.85 * pixels) << program;
}

// What the pixel's size fades or ends still changes within it, and so does noise at places that are
// made of noise; how fine that is its neighbours tell.
TEST(Fine, WhereNeighboursDeviate) {
  for (const char* program :
       {"c = turbulence(10 * [x y])\n", "c = fbm(10 * [x y])\n",
        "_p = 9 * [x y] + vnoise([x y 0]).xy\nc = Noise(_p.x, _p.y)\n",
        "c = 0\nf = 1\nwhile f < 1 / pixelsize\n    c += abs(Noise(f * x, f * y)) / f\n    f *= "
        "2\n"}) {
    EXPECT_GT(sampled(program), 0.4 * pixels) << program;
    EXPECT_EQ(sampled(std::string(program) + "c = 0.5 + 0.004 * c\n"), 0) << program;
  }
}

TEST(Fine, NotWhatIsNotSeenNorWhatRaysFind) {
  for (const char* program : {"c = 0.5 + 0.002 * Noise(40 * x, 40 * y)\n",
                              "c = Noise(3 * time, 0.2)\n", "c = sin(40 * time) + 0.1 * x\n"})
    EXPECT_EQ(sampled(program), 0) << program;
  CompiledFront front =
      lowered("t = 0\nwhile t < 2 + u\n    t += 0.3 + 0.2 * Noise(9 * x, t)\nc = t\n");
  passes::remove_dead(front.module);
  EXPECT_FALSE(find_decisions(front.module, image_plane_changes(std::nullopt)).any_noise);
}

TEST(Fine, WhereTheSlopeSaysSo) {
  // 16 |x| / 16 cells per pixel, so beyond |x| = 0.3 alone.
  const std::string program = "c = Noise(8 * x * x, 0.3 + y)\n";
  // Where nothing is sampled there is what a pixel's neighbours alone make of it.
  const auto smooth = [](const Picture& of, int x, int y) {
    const Smoothing by = smoothing_of(Filter());
    const auto both = [&](int dx, int dy) { return of.at(x + dx, y + dy) + of.at(x - dx, y - dy); };
    const float straight = by.axis * (both(1, 0) + both(0, 1) - 4 * of.at(x, y)),
                most = std::abs(straight),
                slanting = by.diagonal * (both(1, 1) + both(1, -1) - 4 * of.at(x, y));
    return of.at(x, y) + straight + std::clamp(slanting, -most, most);
  };
  const Picture plainly = render(program, {.antialias = plain()});
  const Picture ours = render(program, {.antialias = procedural()});
  int changed = 0, beyond = 0;
  for (int y = 1; y < 31; ++y)
    for (int x = 1; x < 31; ++x) {
      const double place = std::abs((x + 0.5) / 16 - 1);
      const bool is_fine = place * place > 0.09;
      beyond += is_fine ? 1 : 0;
      const bool changes = std::abs(ours.at(x, y) - smooth(plainly, x, y)) > 1e-6f;
      changed += changes ? 1 : 0;
      EXPECT_TRUE(is_fine || !changes) << x << " " << y;
    }
  EXPECT_GT(changed, 0.85 * beyond);
  EXPECT_GE(ours.counts.supersampled, changed);
}

TEST(Fine, InTheBranchThatIsTaken) {
  const std::string program = "c = 0.5\nif y < -0.01\n    c = Noise(40 * x, 40 * y)\n";
  const Picture picture = render(program, {.antialias = procedural()});
  EXPECT_GT(picture.counts.supersampled, 0.45 * pixels);
  EXPECT_LT(picture.counts.supersampled, 0.55 * pixels);
}

// Beside 16 samples what the neighbours say counts as one more.
TEST(Fine, NeighboursAreASampleMore) {
  const std::string program = "c = Noise(px / 1.1, py / 1.1, 0.4)\n";
  const auto with = [&](const Options& options) {
    return render(program, {.width = 64, .height = 64, .antialias = options});
  };
  const Picture truth = with(samples(1024)), ours = with(procedural()), many = with(samples(16));
  EXPECT_GT(ours.counts.supersampled, 0.85 * 64 * 64);
  double error = 0, error_of_many = 0;
  for (std::size_t i = 0; i < truth.plane().size(); ++i) {
    error += std::pow(ours.plane()[i] - truth.plane()[i], 2.0);
    error_of_many += std::pow(many.plane()[i] - truth.plane()[i], 2.0);
  }
  EXPECT_LT(error, 0.95 * error_of_many);
}

// Waves shorter than three pixels, of which the neighbours tell nothing. An edge of waves is an
// edge.
TEST(Fine, WavesToo) {
  EXPECT_EQ(sampled("c = rotate([x y], 90).x\n"), 0);
  const std::string zones = "c = 0.5 + 0.5 * cos(40 * (x * x + y * y))\n";
  const Picture truth = render(zones, {.antialias = samples(256)}),
                ours = render(zones, {.antialias = procedural()}),
                many = render(zones, {.antialias = samples(16)});
  double error = 0, error_of_many = 0;
  for (std::size_t i = 0; i < truth.plane().size(); ++i) {
    error += std::pow(ours.plane()[i] - truth.plane()[i], 2.0);
    error_of_many += std::pow(many.plane()[i] - truth.plane()[i], 2.0);
  }
  EXPECT_LT(error, 0.7 * error_of_many);
  CompiledFront edges = lowered("c = sin(90 * x) > 0.2 ? 1 : 0\n");
  passes::remove_dead(edges.module);
  EXPECT_FALSE(find_decisions(edges.module, image_plane_changes(std::nullopt)).any_noise);
}

// An edge is no deviation of noise.
TEST(Fine, EdgesInSlightNoiseAreBlended) {
  const std::string program = "c = x + 0.3 * y > 0.02 ? 1 : 0\nc += 0.01 * Noise(40 * x, 40 * y)\n";
  const Picture picture = render(program, {.antialias = procedural()});
  EXPECT_GE(picture.counts.blended, 32);
  EXPECT_EQ(picture.counts.supersampled, 0);
}

}  // namespace
}  // namespace pse::antialias::test
