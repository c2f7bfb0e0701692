// Discs of every radius against the exact response of the kernel, integrated here. Small discs are
// the hard ones: a pixel may hold all of one, and all of its neighbours miss it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "antialias/decisions.h"
#include "exact_share.h"
#include "passes/passes.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr double one_step = 1.0 / 255;

std::string text(double value) { return "(" + std::to_string(value) + ")"; }

// The area of a disc within the unit square around (dx, dy) from its centre, by columns.
double box_share(double dx, double dy, double radius) {
  constexpr int columns = 4000;
  double area = 0;
  for (int i = 0; i < columns; ++i) {
    const double x = dx - 0.5 + (i + 0.5) / columns, h2 = radius * radius - x * x;
    if (h2 <= 0) continue;
    const double h = std::sqrt(h2);
    area += std::max(0.0, std::min(h, dy + 0.5) - std::max(-h, dy - 0.5)) / columns;
  }
  return area;
}

// The density of round kernels at the distance r from the middle, and where it ends.
double density(FilterKind kind, double r) {
  using std::numbers::pi;
  switch (kind) {
    case FilterKind::cubic:
      return 12 / pi * std::sqrt(std::max(0.25 - r * r, 0.0));
    case FilterKind::disc:
      return 1 / pi;
    case FilterKind::cone:
      return 3 / pi * (1 - r);
    case FilterKind::paraboloid:
      return 2 / pi * (1 - r * r);
    default:
      return 2 / pi * std::exp(-2 * r * r);
  }
}
double end_of(FilterKind kind) {
  return kind == FilterKind::cubic ? 0.5 : kind == FilterKind::gauss ? 3 : 1;
}

// What a disc holds of a kernel that is (dx, dy) from its middle.
double exact_share(FilterKind kind, double dx, double dy, double radius) {
  if (kind == FilterKind::box) return box_share(dx, dy, radius);
  const double a = std::hypot(dx, dy), end = end_of(kind);
  if (kind == FilterKind::cubic) return share_of_disc(a, radius);
  constexpr int rings = 2000;
  double share = 0;
  for (int i = 0; i < rings; ++i) {
    const double r = (i + 0.5) / rings * end;
    const double angle =
        a + r <= radius ? std::numbers::pi
        : std::abs(a - r) >= radius
            ? 0
            : std::acos(std::clamp((a * a + r * r - radius * radius) / (2 * a * r), -1.0, 1.0));
    share += density(kind, r) * 2 * angle * r * end / rings;
  }
  return share;
}

// A disc at (cx, cy) of a picture of so many pixels, said in three ways; the others are distances
// of which the slope is known beforehand (bent.h).
constexpr int forms = 3, all_forms = 8;
std::string disc(int form, int size, double cx, double cy, double radius) {
  const std::string place =
      "_p = [u, 1 - v] * " + std::to_string(size) + " - [" + text(cx) + ", " + text(cy) + "]\n";
  const char* conditions[all_forms] = {"length(_p) < _r",
                                       "dot(_p, _p) < _r * _r",
                                       "_p.x * _p.x + _p.y * _p.y - _r * _r < 0",
                                       "abs(length(_p) + 3) < 3 + _r",
                                       "-length(_p) / 4 > -_r / 4",
                                       "max(length(_p), -1) - _r < 0",
                                       "length(rotate(0.3 * _p, 0.7)) < 0.3 * _r",
                                       "_r - length([_p.x, _p.y, 0]) * 2 > -length(_p)"};
  return "_r = " + text(radius) + "\n" + place + "c = " + conditions[form] + " ? 1 : 0\n";
}

// The worst error of discs at so many places between pixels.
double worst_error(FilterKind kind, double radius, int form, int places) {
  const int around = 3 + static_cast<int>(std::ceil(end_of(kind)));
  const int size = 2 * static_cast<int>(std::ceil(radius)) + 2 * around - 1;
  double worst = 0;
  for (int place = 0; place < places; ++place) {
    // Places spread over the pixel; the first is its middle, the second its corner.
    const double golden = 0.6180339887;
    const double cx = size / 2 + (place == 0 ? 0.5 : place == 1 ? 0 : std::fmod(place * golden, 1));
    const double cy = size / 2 + (place == 0   ? 0.5
                                  : place == 1 ? 0
                                               : (place - 1.5) / std::max(places - 2, 1));
    const Picture picture =
        render(disc(form, size, cx, cy, radius),
               {.width = size, .height = size, .interpret = true, .antialias = procedural(kind)});
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
        const double apart = std::abs(std::hypot(dx, dy) - radius);
        const double exact =
            apart > 3 ? (std::hypot(dx, dy) < radius ? 1 : 0) : exact_share(kind, dx, dy, radius);
        worst = std::max(worst, std::abs(double(picture.at(x, y)) - exact));
      }
  }
  return worst;
}

const std::vector<double> every_radius = {0.05, 0.1, 0.2, 0.25, 0.35, 0.5,  0.6,  0.7,
                                          0.8,  0.9, 1.0, 1.15, 1.3,  1.45, 1.6,  1.8,
                                          2.0,  2.3, 2.6, 3.7,  5.2,  7.0,  11.3, 20};

// The integrals themselves: reference/antialias.json, disc_box, and a disc that holds the kernel.
TEST(Discs, TheExactResponses) {
  EXPECT_NEAR(box_share(0, 0, 0.25), 0.19634954084936207, 1e-5);
  EXPECT_NEAR(box_share(0, 0, 0.5), 0.7853981633974483, 1e-5);
  EXPECT_NEAR(box_share(0, 0, 0.6), 0.9509111307851082, 1e-5);
  EXPECT_NEAR(box_share(0, 0, 0.70710678), 1, 1e-5);
  EXPECT_EQ(share_of_disc(0, 0.5), 1);
  // The kernel (12 / pi) sqrt(1/4 - r^2) integrated to r: 1 - (1 - 4 r^2)^(3/2).
  EXPECT_NEAR(share_of_disc(0, 0.3), 1 - std::pow(1 - 4 * 0.09, 1.5), 1e-3);
}

TEST(Discs, OfEveryRadiusAreWithinOneStep) {
  for (const FilterKind kind : {FilterKind::cubic, FilterKind::box})
    for (const double radius : every_radius)
      for (int form = 0; form < forms; ++form)
        EXPECT_LT(worst_error(kind, radius, form, radius < 4 ? 8 : 3), one_step)
            << (kind == FilterKind::box ? "box " : "cubic ") << radius << " form " << form;
}

TEST(Discs, OfDistancesInOtherWordsAreSeen) {
  for (const double radius : {0.1, 0.25, 0.5, 0.7})
    for (int form = forms; form < all_forms; ++form)
      EXPECT_LT(worst_error(FilterKind::cubic, radius, form, 5), one_step) << radius << ' ' << form;
}

// Where a pixel's way is stretched more along one direction, the largest counts: none is missed.
TEST(Discs, ThatAreStretchedAreSeen) {
  for (const char* stretched : {"[3 * _p.x, _p.y]", "[_p.x + 2 * _p.y, _p.y]",
                                "rotate([_p.x, 4 * _p.y], 0.4)", "[_p.x, _p.y, 2 * _p.x - _p.y]"})
    for (const double at : {8.0, 8.2, 8.45}) {
      const std::string program = "_p = [u, 1 - v] * 16 - [" + text(at) + ", " + text(8.1) +
                                  "]\nc = length(" + stretched + ") < 0.6 ? 1 : 0\n";
      const auto sum = [&](const Options& by) {
        const Picture picture =
            render(program, {.width = 16, .height = 16, .interpret = true, .antialias = by});
        double all = 0;
        for (const float value : picture.planes[0]) all += value;
        return all;
      };
      const double exact = sum(samples(2048));
      EXPECT_GT(exact, 0.1) << program;
      // By 32 samples, since it is no circle.
      EXPECT_NEAR(sum(procedural()), exact, 0.4 * exact) << program;
    }
}

// Said where slopes were thought dear, or are infinite: in a loop that leaves at the first disc,
// and by a root that is no number beyond the edge.
TEST(Discs, InLoopsThatLeaveAndUnderRootsAreTheSame) {
  for (const double radius : {0.2, 0.5, 0.8, 1.3, 5.2})
    for (const double at : {6.0, 6.5, 6.3}) {
      const std::string place = "_p = [u, 1 - v] * 13 - " + text(at) + "\n";
      for (const std::string& program :
           {"c = 0\nfor i in [1 .. 3]\n    if length(_p - [90 * (i - 2), 0]) < " + text(radius) +
                "\n        c = 1\n        break\n",
            "c = sqrt(1 - dot(_p, _p) / " + text(radius * radius) + ") > 0\n"}) {
        const Picture picture =
            render(place + program,
                   {.width = 13, .height = 13, .interpret = true, .antialias = procedural()});
        for (int y = 0; y < 13; ++y)
          for (int x = 0; x < 13; ++x)
            EXPECT_NEAR(picture.at(x, y),
                        share_of_disc(std::hypot(x + 0.5 - at, y + 0.5 - at), radius), one_step)
                << program << at << ": " << x << ' ' << y;
      }
    }
}

// Dots of a quarter of a pixel to one and a half, most of them between the samples.
const char* dots =
    "_p = [u, 1 - v] * 32\n_cell = floor(_p / 8)\n_d = _p - 8 * _cell - 3 - 2 * [hash(_cell.x, "
    "_cell.y), hash(_cell.y, _cell.x)]\n_r = 0.25 + 1.2 * hash(_cell.x, _cell.y, 3)\n"
    "c = length(_d) < _r ? 0.25 + 0.5 * u : 1\n";

TEST(Discs, AreTheSameBitsHoweverTheyAreComputed) {
  const Picture picture = render(dots, {.interpret = true, .antialias = procedural()});
  EXPECT_GT(picture.counts.blended, 16);
  EXPECT_EQ(picture.counts.supersampled, 0);
  for (const int width : {1, 4, 8, 16})
    EXPECT_EQ(render(dots, {.vector_width = width, .antialias = procedural()}).planes,
              picture.planes)
        << width;
  EXPECT_EQ(render(dots, {.tile = 7, .threads = 2, .antialias = procedural()}).planes,
            picture.planes);
}

bool asks(const std::string& text) {
  CompiledFront front = lowered(text);
  passes::remove_dead(front.module);
  return find_decisions(front.module, image_plane_changes(std::nullopt)).any_bent;
}

// What is piecewise linear, or a ratio of linear functions, has no peak between the samples; noise
// may have one, but would be dear.
TEST(Discs, OnlyWhatBendsIsAskedFor) {
  for (const char* text :
       {"c = u + 2 * v < 1 ? 1 : 0\n", "c = fract(3 * u) < 0.4 ? 1 : 0\n",
        "c = (floor(x / (1.2 - y)) + floor(1 / (1.2 - y))) % 2\n",
        "_w = 1 / (3 - y)\nc = 0.7 * x * _w + 2 * _w < 1 ? 1 : 0\n",
        "c = max(abs(x), abs(y)) < 0.5 ? 1 : 0\n", "c = Noise(3 * x, y) > 0 ? 1 : 0\n",
        "c = 0\nfor i in [1 .. 4]\n    if u * i < 1\n        c += 1\n",
        // Iterates: the slopes of all turns before.
        "z = u\nc = 0\nwhile c < 9 and z * z < 4\n    z = z * z + v\n    c += 1\n"})
    EXPECT_FALSE(asks(text)) << text;
  for (const char* text :
       {"c = length([x y]) < 0.1 ? 1 : 0\n", "c = x * x + y * y < 0.1 ? 1 : 0\n",
        "c = x * y > 0.1 ? 1 : 0\n", "c = sin(9 * x) > 0.2 ? 1 : 0\n",
        "c = x / (2 - x - y) < y ? 1 : 0\n", "c = floor(9 * length([x y]))\n",
        "c = 0\nfor i in [1 .. 4]\n    if length([x - i / 4, y]) < 0.1\n        c += 1\n",
        "c = 0\nfor i in [1 .. 4]\n    if length([x - i / 4, y]) < 0.1 break\n    c += 1\n"})
    EXPECT_TRUE(asks(text)) << text;
}

// Run by hand (--gtest_also_run_disabled_tests): prints the worst errors in steps of 1/255.
TEST(Discs, DISABLED_Table) {
  using enum FilterKind;
  const std::pair<FilterKind, const char*> kinds[] = {
      {cubic, "cubic"},           {box, "box"},    {disc, "disc"}, {cone, "cone"},
      {paraboloid, "paraboloid"}, {gauss, "gauss"}};
  for (const auto& [kind, name] : kinds)
    for (int form = 0; form < 2; ++form) {
      std::printf("%s, form %d:", name, form);
      for (const double radius : every_radius)
        std::printf(" %g: %.2f", radius, worst_error(kind, radius, form, 12) / one_step);
      std::printf("\n");
    }
}

}  // namespace
}  // namespace pse::antialias::test
