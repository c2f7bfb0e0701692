// Diagnostics as data: order, repetitions, limits, and the nearest name.
#include <gtest/gtest.h>

#include "diag/diagnostics.h"

namespace pse::test {

namespace {

Span at(std::uint32_t begin, std::uint32_t end, FileId file = 0) { return {file, begin, end}; }

std::string codes(const Diagnostics& diagnostics) {
  std::string out;
  for (const Diagnostic& diagnostic : diagnostics.all()) out += diagnostic.code + " ";
  return out;
}

}  // namespace

TEST(Diagnostics, SortsByPlaceAndDropsRepetitions) {
  Diagnostics diagnostics;
  diagnostics.error("c", at(9, 10), "m");
  diagnostics.error("f", {}, "without a place, at the end");
  diagnostics.error("e", at(0, 1, 1), "in another file");
  diagnostics.warning("w", at(4, 5), "a warning");
  diagnostics.error("b", at(4, 5), "an error there comes first");
  diagnostics.error("c", at(9, 10), "m");
  diagnostics.error("c", at(9, 10), "another message");
  diagnostics.error("a", at(1, 2), "m");
  EXPECT_EQ(diagnostics.error_count(), 7u);
  diagnostics.sort();
  EXPECT_EQ(codes(diagnostics), "a b w c c e f ");
  EXPECT_EQ(diagnostics.error_count(), 6u);
}

TEST(Diagnostics, KeepsTheFirstHundredErrorsAndCountsTheRest) {
  Diagnostics diagnostics;
  for (std::uint32_t i = 0; i < 250; ++i) diagnostics.warning("w", at(i, i), "m");
  for (std::uint32_t i = 0; i < Diagnostics::limit; ++i) diagnostics.error("e", at(i, i), "m");
  EXPECT_EQ(diagnostics.all().size(), 2 * Diagnostics::limit);
  diagnostics.error("e", at(999, 999), "one more");
  EXPECT_EQ(diagnostics.all().size(), 2 * Diagnostics::limit);
  EXPECT_EQ(diagnostics.error_count(), Diagnostics::limit + 1);
  EXPECT_TRUE(diagnostics.has_errors());
}

TEST(Diagnostics, WarningsAreNoErrors) {
  Diagnostics diagnostics;
  diagnostics.warning("w", at(0, 1), "m");
  EXPECT_FALSE(diagnostics.has_errors());
}

TEST(NearestName, FindsMisspellings) {
  const std::vector<std::string> names = {"turbulence", "direction", "distance", "norm", "noise",
                                          "Noise",      "PI",        "sin",      "asin"};
  EXPECT_EQ(nearest_name("turbulance", names), "turbulence");
  EXPECT_EQ(nearest_name("trubulence", names), "turbulence");  // two letters swapped count once
  EXPECT_EQ(nearest_name("nrom", names), "norm");
  EXPECT_EQ(nearest_name("Direction", names), "direction");
  EXPECT_EQ(nearest_name("pi", names), "PI");
  EXPECT_EQ(nearest_name("nois", names), "noise");
  EXPECT_EQ(nearest_name("NOISE", names), "Noise");
  EXPECT_EQ(nearest_name("sine", names), "sin");
}

TEST(NearestName, FindsALongerNameByAWord) {
  const std::vector<std::string> names = {"rgb_to_hsv", "hsv_to_rgb", "soft_sphere", "sphere_span",
                                          "soft_box",   "hot_box_2",  "noise"};
  EXPECT_EQ(nearest_name("hsv", names), "hsv_to_rgb");
  EXPECT_EQ(nearest_name("box", names), "soft_box");
  EXPECT_EQ(nearest_name("sphere", names), "sphere_span");
  EXPECT_EQ(nearest_name("to", names), "");
  EXPECT_EQ(nearest_name("here", names), "");
}

TEST(NearestName, IsSilentWhereNothingIsNear) {
  const std::vector<std::string> names = {"turbulence", "norm", "x"};
  EXPECT_EQ(nearest_name("marble", names), "");
  EXPECT_EQ(nearest_name("y", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("norm", names), "");  // the name itself is no suggestion
  EXPECT_EQ(nearest_name(std::string(100'000, 'a'), names), "");
}

}  // namespace pse::test
