// Discs of every radius against the exact response of the kernel, integrated here. Small discs are
// the hard ones: a pixel may hold all of one, and all of its neighbours miss it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "exact_share.h"
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

// The worst error of discs at twelve places between pixels.
double worst_error(FilterKind kind, double radius) {
  const int size = 2 * static_cast<int>(std::ceil(radius)) + 5;
  double worst = 0;
  for (int place = 0; place < 12; ++place) {
    // Places spread over the pixel; the first is its middle, the second its corner.
    const double golden = 0.6180339887;
    const double cx = size / 2 + (place == 0 ? 0.5 : place == 1 ? 0 : std::fmod(place * golden, 1));
    const double cy = size / 2 + (place == 0 ? 0.5 : place == 1 ? 0 : (place - 1.5) / 10);
    const Picture picture =
        render("_x = u * " + std::to_string(size) + "\n_y = (1 - v) * " + std::to_string(size) +
                   "\nc = (_x - " + text(cx) + ") ^ 2 + (_y - " + text(cy) + ") ^ 2 < " +
                   text(radius * radius) + " ? 1 : 0\n",
               {.width = size, .height = size, .interpret = true, .antialias = procedural(kind)});
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double dx = x + 0.5 - cx, dy = y + 0.5 - cy;
        const double exact =
            kind == FilterKind::box ? box_share(dx, dy, radius) : share_of_disc(std::hypot(dx, dy), radius);
        worst = std::max(worst, std::abs(double(picture.at(x, y)) - exact));
      }
  }
  return worst;
}

const std::vector<double> every_radius = {0.1, 0.2, 0.25, 0.35, 0.5,  0.6, 0.7, 0.8,
                                          0.9, 1.0, 1.15, 1.3,  1.45, 1.6, 1.8, 2.0,
                                          2.3, 2.6, 3.7,  5.2,  7.0,  11.3};

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

// Within 1/255 wherever the disc lies between the pixels. The other radii of every_radius have a
// place where they are not: docs/decisions/2026-11-28-fading-and-stored-pixels.md.
TEST(Discs, OfRadiiThatHold) {
  for (const double radius : {1.45, 1.6, 1.8, 2.0, 2.3, 2.6, 3.7, 5.2, 7.0, 11.3})
    EXPECT_LT(worst_error(FilterKind::cubic, radius), one_step) << radius;
  for (const double radius : {5.2, 7.0, 11.3})
    EXPECT_LT(worst_error(FilterKind::box, radius), one_step) << radius;
}

// Run by hand (--gtest_also_run_disabled_tests): prints the worst error at each radius, in steps of
// 1/255, and fails at each where it is above one.
TEST(Discs, DISABLED_OfEveryRadius) {
  for (const FilterKind kind : {FilterKind::cubic, FilterKind::box})
    for (const double radius : every_radius) {
      const double error = worst_error(kind, radius) / one_step;
      std::printf("%s radius %5.2f: %.2f / 255\n", kind == FilterKind::box ? "box  " : "cubic",
                  radius, error);
      EXPECT_LT(error, 1) << radius;
    }
}

}  // namespace
}  // namespace pse::antialias::test
