// Pictures with clean edges: against the exact response of the kernel, against many samples, and
// against themselves computed in other pieces.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "exact_share.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

using enum FilterKind;
constexpr double one_step = 1.0 / 255;

// Places in pixels.
std::string axes() { return "_x = px\n_y = py\n"; }
// The same from places in the picture.
std::string axes(int size) {
  return "_x = u * " + std::to_string(size) + "\n_y = (1 - v) * " + std::to_string(size) + "\n";
}

std::string text(double value) { return "(" + std::to_string(value) + ")"; }

// Worst difference from the exact share of a half-plane at many angles and distances.
double worst_half_plane(FilterKind kind, const Options& options,
                        const std::string& names = axes(24)) {
  double worst = 0;
  for (int step = 0; step < 24; ++step) {
    const double angle = (step * 15 + 3.7) * std::numbers::pi / 180;
    const double nx = std::cos(angle), ny = std::sin(angle), out = 12.3 + 0.037 * step;
    const Picture picture =
        render(names + "c = select((_x - 12) * " + text(nx) + " + (_y - 12) * " + text(ny) + " > " +
                   text(out - 12) + ", 1, 0)\n",
               {.width = 24, .height = 24, .interpret = true, .antialias = options});
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        const double d = (x + 0.5 - 12) * nx + (y + 0.5 - 12) * ny - (out - 12);
        const double exact = Filter(kind).share(static_cast<float>(d), static_cast<float>(nx),
                                                static_cast<float>(ny));
        worst = std::max(worst, std::abs(picture.at(x, y) - exact));
      }
  }
  return worst;
}

TEST(Pictures, HalfPlanesAtEveryAngleAreExact) {
  for (const FilterKind kind : {cubic, box, disc, cone, paraboloid, gauss})
    EXPECT_LT(worst_half_plane(kind, procedural(kind)), one_step / 2) << int(kind);
  EXPECT_LT(worst_half_plane(cubic, procedural(), axes()), one_step / 2);
  EXPECT_GT(worst_half_plane(cubic, plain()), 0.4);  // what the test would find
}

TEST(Pictures, DiscsFromLargeToSmallAreExact) {
  for (const double radius : {11.3, 7.0, 5.2, 3.7, 2.6, 2.0, 1.6, 1.3}) {
    for (const double shift : {0.0, 0.31}) {
      const double cx = 16 + shift, cy = 16 - shift / 2;
      const Picture picture =
          render(axes(32) + "c = select((_x - " + text(cx) + ") ^ 2 + (_y - " + text(cy) +
                     ") ^ 2 < " + text(radius * radius) + ", 1, 0)\n",
                 {.interpret = true, .antialias = procedural()});
      double worst = 0;
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const double exact = share_of_disc(std::hypot(x + 0.5 - cx, y + 0.5 - cy), radius);
          worst = std::max(worst, std::abs(picture.at(x, y) - exact));
        }
      EXPECT_LT(worst, one_step) << radius;
      EXPECT_GT(picture.counts.blended, 0);
    }
  }
}

// Programs whose edges nest, bend, meet, come from loops, returns, whole numbers.
const std::vector<std::pair<const char*, const char*>> programs = {
    {"nested",
     "f = (u - .5) ^ 2 + (v - .5) ^ 2 - .3 ^ 2\nif f > 0\n    c = Noise(8 * u, 8 * v)\n"
     "else\n    if sin(20 * u + Noise(u, v) / 10) * sin(20 * v + Noise(u, v) / 10) > 0\n"
     "        c = .5 + Noise(3 * u, v)\n    else\n        c = 0.1\n"},
    {"checker", "z = 1 / (1.3 - y)\na = floor(6 * x * z) + floor(6 * z)\nc = mod(a, 2)\n"},
    {"returns",
     "function f(p)\n    if p.x * p.y > 0.1\n        return 1\n    if length(p) < 0.4\n"
     "        return 0.5\n    return 0.2 * p.x\nc = f([x y])\n"},
    {"loop",
     "c = 0\nfor i in [1 .. 6]\n    if length([x - i / 4 + 0.8 y]) < 0.3\n        c += "
     "0.17\n"},
    {"while", "n = 0\nr = length([x y]) + 0.2\nwhile r < 1\n    r *= 1.4\n    n += 1\nc = n / 5\n"},
    {"kinks", "d = max(abs(x) - 0.6, abs(y) - 0.4)\nc = saturate(1 - 300 * d)\n"},
    {"corners", "d = max(abs(x + y / 3) - 0.6, abs(y) - 0.4)\nc = select(d < 0, 1, 0)\n"},
    {"table", "t = [0.1 0.9 0.3 0.7]\nc = t[1 + floor(3.99 * u)]\n"},
    {"array",
     "a = array(4)\nfor i in [1 .. 4]\n    a[i] = length([x - i / 3 + 0.8 y - 0.1])\nc = 0\n"
     "for d in a\n    if d < 0.25\n        c += 0.3\n"},
    {"noise", "c = 0.2\nif Noise(3 * x, 3 * y) > 0.1 and x + y < 0.8\n    c = 1\n"},
    // Towards the horizon whole squares lie between two samples.
    {"horizon",
     "h = 0.35 - y\nc = 0.5\nif h > 0\n    d = 0.5 / h\n    s = floor(0.9 * x * d + 0.4 * d) + "
     "floor(0.9 * d - 0.4 * x * d)\n    c = mix(mod(s, 2), 0.5, 1 - exp(-0.04 * d))\n"},
    {"march",
     "function ball(p)\n    return norm(p - [0 0 3]) - 0.8\nt = 1\nd = direction([x y 3])\n"
     "for i in [1 .. 60]\n    s = ball(t * d)\n    t += s\n    if s < 0.0005 or t > 5 break\n"
     "c = t > 5 ? 0.1 : 1.6 - 0.4 * t\nif t < 5 and sin(9 * t * d.x) > 0\n    c += 0.3\n"},
    // A third of a pixel wide, by each of the two creases that may hold one.
    {"lines",
     "t = abs(fract(4 * (x + 0.07 * y)) - 0.5)\nc = select(t < 4 * pixelsize / 6, 0, 1)\n"},
    {"grid",
     "p = abs(fract(rotate([x y], 0.21) * 3) - 0.5)\n"
     "c = select(max(p.x, p.y) > 0.5 - 0.6 * pixelsize, 0.1, 0.9)\n"},
    {"borders",
     "p = 3 * [x y]\ni = floor(p)\na = 9\nb = 9\nfor k in [0 .. 8]\n"
     "    q = i + [k % 3 - 1, floor(k / 3) - 1]\n"
     "    d = length(p - q - [hash(q, 1) hash(q, 2)])\n    if d < a\n        b = a\n"
     "        a = d\n    else if d < b\n        b = d\nc = select(b - a < 0.06, 0, 1)\n"},
    {"cone", "p = rotate([x y], 0.3)\nc = 0.5 + atan2(p.y, p.x) / TAU\n"},
    {"sides", "q = x - 0.4 * y\nc = 0.5 + 0.4 * q / abs(q)\n"},
    {"first",
     "c = 0\nfor i in [1 .. 4]\n    if length([x - i / 3 + 0.8 y]) < 0.1 * i\n"
     "        c = 1\n        break\n"},
    // Where hardly a neighbour goes the same way, two edges do not tell of the others.
    {"crowd",
     "h = 0.95 - y\nc = 0.5\nif h > 0\n    d = 3 / h\n"
     "    c = mod(floor(x * d) + floor(1.3 * d), 2)\n"},
    // Finer than a pixel: everywhere, towards a horizon, and where there are edges.
    {"fine", "c = Noise(80 * x, 80 * y)\n"},
    {"fine far", "c = 0.5\nif y < 0\n    z = 0.5 / -y\n    c += Noise(4 * x * z, 4 * z)\n"},
    {"fine grain",
     "c = 0.5\nif length([x y]) < 0.6\n    c = 0.2\nc += 0.2 * Noise(90 * x, 90 * y)\n"},
    // Thin lines where noise folds; iterates whose slopes mislead; both jump beside what they part.
    {"contours", "c = select(fract(12 * noise(3 * [x y 0])) < 0.1, 0, 1)\n"},
    {"noise line", "c = select(abs(noise(4 * [x y 0])) < 0.01, 0, 1)\n"},
    {"iterates",
     "z = 1.4 * [x y]\nn = 0\nfor i in [1 .. 40]\n    if dot(z, z) > 4 break\n"
     "    z = [z.x * z.x - z.y * z.y - 0.745, 2 * z.x * z.y + 0.113]\n    n = i\n"
     "c = (n / 40) ^ 0.7\n"},
    {"pow", "c = select(pow(abs(x), 2.5) + pow(abs(y), 2.5) < 0.5, 1, 0)\n"},
};

double distance(const Picture& a, const Picture& b) {
  double sum = 0;
  const auto &p = a.plane(), &q = b.plane();
  for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - q[i]) * (p[i] - q[i]);
  return std::sqrt(sum / static_cast<double>(p.size()));
}

TEST(Pictures, NearerToManySamplesThanSixteen) {
  for (const auto& [name, program] : programs) {
    const auto with = [&, program = program](const Options& options) {
      return render(program, {.width = 64, .height = 64, .antialias = options});
    };
    const Picture truth = with(samples(512));
    const double ours = distance(with(procedural()), truth);
    // Fine noise gets 16 samples itself, where its neighbours tell of it.
    const double as_good = std::string(name).starts_with("fine") ? 1.35 : 1;
    EXPECT_LT(ours, as_good * distance(with(samples(16)), truth)) << name;
    const double most = std::string(name) == "crowd" ? 0.12 : 0.25;
    EXPECT_LT(ours, most * distance(with(plain()), truth)) << name;
  }
}

TEST(Pictures, TheSameBitsInEveryPiece) {
  for (const auto& [name, program] : programs) {
    const auto with = [&, program = program](PictureOptions options) {
      options.width = 70, options.height = 41;
      options.antialias = procedural();
      return render(program, options);
    };
    const Picture whole = with({.tile = 512});
    for (const int tile : {8, 33})
      EXPECT_EQ(with({.tile = tile, .threads = 2}).planes, whole.planes) << name << tile;
    for (const int width : {1, 4, 8})
      EXPECT_EQ(with({.vector_width = width}).planes, whole.planes) << name << width;
    EXPECT_EQ(with({.interpret = true}).planes, whole.planes) << name;
    const Picture part = with({.tile = 16, .clip = {11, 7, 40, 30}});
    for (int y = 7; y < 30; ++y)
      for (int x = 11; x < 40; ++x) ASSERT_EQ(part.at(x - 11, y - 7), whole.at(x, y)) << name;
  }
}

TEST(Pictures, WhatHasNoEdgesHasNoneFound) {
  for (const char* program :
       {"c = Noise(4 * x, 4 * y)\n", "c = 0.05 * turbulence([x y])\n", "c = abs(x) + max(x, 0.1 * x)\n",
        "_t = 0\n_d = 1\nwhile _d > 0.1\n    _d -= 0.013 + 0.01 * u\n    _t += 0.013 + 0.01 * u\nc "
        "= u + "
        "0 * _t\n",
        "c = u\nif x < 0\n    c = u + 0 * x\n"}) {
    const Picture none = render(program, {.antialias = plain()});
    const Picture ours = render(program, {.antialias = procedural()});
    // Smoothed at most (test_smooth.cpp).
    for (std::size_t i = 0; i < none.plane().size(); ++i)
      EXPECT_NEAR(ours.plane()[i], none.plane()[i], 0.1) << program;
    EXPECT_EQ(ours.counts.blended + ours.counts.supersampled, 0) << program;
  }
}

// Two stripes in each pixel, and every middle is on a white one.
// A ring that hides part of itself, seen by rays that march and shaded by its depth: no conditional
// but the march tells one part from the other. `paint` is done to the colour c at p.
std::string marched(const std::string& paint) {
  return R"(function scene(p)
    q = p - [0 0 6]
    r = [q.x, .92 * q.y - .392 * q.z, .392 * q.y + .92 * q.z]
    return norm([norm([r.x, r.z]) - 1.15, r.y]) - .5
_d = direction([2 * u - 1, 2 * v - 1, 3])
_t = 3
for _i in [1 .. 100]
    _s = scene(_t * _d)
    _t += _s
    if _s < 0.0005 or _t > 9 break
_p = min(_t, 9) * _d
c = _t > 9 ? 0 : .9 - .25 * (_t - 4)
)" + paint;
}
Picture marched(const std::string& paint, const Options& options) {
  return render(marched(paint), {.width = 96, .height = 96, .antialias = options});
}

TEST(Pictures, MarchedOutlinesAreSeenAndNothingElse) {
  const Picture ours = marched("", procedural()), plainly = marched("", plain()),
                many = marched("", samples(256));
  EXPECT_LT(distance(ours, many), 0.15 * distance(plainly, many));
  // The outlines are some 350 pixels long, and the kernel reaches over four.
  EXPECT_GT(ours.counts.filtered, 500);
  EXPECT_LT(ours.counts.filtered, 1500);
  // Where it hides itself only the depth jumps.
  double worst = 0, without = 0;
  for (int y = 42; y < 51; ++y)
    for (int x = 38; x < 58; ++x) {
      worst = std::max(worst, std::abs(double(ours.at(x, y)) - many.at(x, y)));
      without = std::max(without, std::abs(double(plainly.at(x, y)) - many.at(x, y)));
    }
  EXPECT_LT(worst, 0.1 * without);
  EXPECT_GT(without, 0.05);
}

TEST(Pictures, EdgesOnMarchedSurfacesAreBlended) {
  const std::string stripes = "c += _t > 9 ? 0 : floor(3 * _p.x + .3) * .1\n";
  const Picture ours = marched(stripes, procedural()), plainly = marched(stripes, plain()),
                many = marched(stripes, samples(256)), bare = marched("", procedural());
  EXPECT_LT(distance(ours, many), 0.15 * distance(plainly, many));
  // The program knows where the stripes are.
  EXPECT_GT(ours.counts.blended, 250);
  EXPECT_LT(ours.counts.supersampled, bare.counts.supersampled + 50);
}

TEST(Pictures, WhatLiesBetweenTheSamplesIsSeen) {
  const std::string stripes = axes(16) + "c = mod(floor(2 * _y + 0.25), 2)\n";
  const PictureOptions size{.width = 16, .height = 16};
  PictureOptions none = size, ours = size;
  none.antialias = plain(), ours.antialias = procedural();
  const Picture white = render(stripes, none), grey = render(stripes, ours);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      ASSERT_EQ(white.at(x, y), 1);
      // From -1/2 to -1/8 and from 3/8 to 1/2 the pixel is black.
      const float black = Filter().share(-0.125f, 0, 1) + 1 - Filter().share(0.375f, 0, 1);
      EXPECT_NEAR(grey.at(x, y), 1 - black, 0.06) << x << ' ' << y;  // of 32 samples, two
    }
}

TEST(Pictures, EdgesAtThePicturesBorderAreSeen) {
  // The pixel's centre and all its neighbours in the picture are on one side.
  const Picture picture = render(axes(4) + "c = select(_x < 0.25, 1, 0)\n",
                                 {.width = 4, .height = 4, .antialias = procedural()});
  const float exact = 1 - Filter().share(0.25f, 1, 0);
  for (int y = 0; y < 4; ++y) EXPECT_NEAR(picture.at(0, y), exact, one_step / 4);
}

TEST(Pictures, ChecksFailOnlyForPixelsOfThePicture) {
  // Left of the picture the index would be 0.
  const std::string program = "t = [0.1 0.9 0.3 0.7]\nc = t[1 + floor(u * width)]\n";
  EXPECT_EQ(render(program, {.width = 4, .height = 4}).result.end, RunEnd::finished);
  const RunResult failed = render(program, {.width = 9, .height = 4, .tile = 8}).result;
  EXPECT_EQ(failed.end, RunEnd::failed);
  EXPECT_EQ(failed.x, 4);
  EXPECT_EQ(failed.y, 0);
}

TEST(Pictures, AValueThatOneSideCannotComputeStaysThere) {
  // Outside the disc the root is NaN: both sides are run where they belong.
  const Picture picture =
      render("r = length([x y])\nc = 0\nif r < 0.7\n    c = sqrt(0.49 - r * r)\n",
             {.antialias = procedural()});
  for (const float value : picture.plane()) EXPECT_FALSE(std::isnan(value));
}

TEST(Pictures, TheMeanOfASlopeOnEachSide) {
  // c = x on one side, 2 + x on the other: blending at the sides' middles is exact for slopes.
  const Picture picture = render(axes(32) + "c = 0.3 * _x\nif _x > 7.8\n    c = 2 + 0.3 * _x\n",
                                 {.antialias = procedural()});
  const double share = Filter().share(-0.3f, 1, 0);
  EXPECT_NEAR(picture.at(7, 9), 0.3 * 7.5 + 2 * share, 1e-3);
}

TEST(Pictures, SupersamplingConvergesToTheKernel) {
  for (const FilterKind kind : {cubic, box, gauss})
    EXPECT_LT(worst_half_plane(kind, samples(1024, kind)), 0.012) << int(kind);
}

}  // namespace
}  // namespace pse::antialias::test
