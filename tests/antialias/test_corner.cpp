// Two edges under one kernel: the weights of their regions by hand, and corners of programs.
#include "antialias/corner.h"

#include <gtest/gtest.h>

#include <numeric>

#include "picture.h"

namespace pse::antialias::test {
namespace {

std::array<float, 4> weights(const Lines& lines) {
  const Filter filter;
  return Corner(lines).weights(filter, Patterns(filter, 64).all());
}

// Regions: 0 behind both lines, 1 before the first, 2 before the second, 3 before both.
TEST(Corner, FourQuartersOfACross) {
  for (const float weight : weights({{0, 1, 0}, {0, 0, 1}})) EXPECT_NEAR(weight, 0.25f, 0.02f);
}

TEST(Corner, AStripHasTheDifferenceOfTheShares) {
  // Both normals to the right: left of both, between them, right of both.
  const auto found = weights({{0.2f, 1, 0}, {-0.1f, 1, 0}});
  const Filter filter;
  EXPECT_NEAR(found[0], 1 - filter.share(0.2f, 1, 0), 0.01f);
  EXPECT_NEAR(found[1], filter.share(0.2f, 1, 0) - filter.share(-0.1f, 1, 0), 0.01f);
  EXPECT_NEAR(found[2], 0, 0.01f);
  EXPECT_NEAR(found[3], filter.share(-0.1f, 1, 0), 0.01f);
  EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0f), 1, 1e-4f);
}

TEST(Corner, ARegionIsUnsureNearALine) {
  const Corner corner({{0, 1, 0}, {0.3f, 0, 1}});
  // Behind the fifth, what is no place.
  constexpr std::array x = {0.2f, -0.2f, 0.2f, 0.01f, -0.2f, 0.2f, 0.2f, 0.2f};
  constexpr std::array y = {0.1f, 0.1f, -0.45f, 0.1f, -0.4f, 0.1f, 0.1f, 0.1f};
  const Corner::Regions found = corner.regions(Offsets{x, y}.part(0, 5));
  EXPECT_EQ(found.sure, (std::array<std::uint32_t, 4>{1u << 4, 1u << 2, 1u << 1, 1u << 0}));
  EXPECT_EQ(found.unsure, (std::array<std::uint32_t, 4>{0, 0, 0, 1u << 3}));
}

// A quarter plane whose corner lies in a pixel's middle: 1/4 of a kernel that is round. 16 samples
// and the shares of its edges come nearer than 64 samples are sure to.
TEST(Corner, OfAProgram) {
  const Picture picture =
      render("_x = u * 9\n_y = (1 - v) * 9\nc = 0\nif _x > 4.5\n    if _y > 4.5\n        c = 1\n",
             {.width = 9, .height = 9, .antialias = procedural()});
  EXPECT_NEAR(picture.at(4, 4), 0.25, 0.03);
  EXPECT_EQ(picture.counts.supersampled > 0, true);
}

}  // namespace
}  // namespace pse::antialias::test
