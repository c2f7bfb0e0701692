// What the settings of every target promise of floating point: a double that is made a float is
// rounded, also where two stand side by side. g++ 12 breaks that when it vectorises straight code
// (docs/decisions/2026-11-28-rounding.md); without -fno-tree-slp-vectorize each of these fails.
#include <gtest/gtest.h>

#include <array>

namespace pse {
namespace {

using Pair = std::array<double, 2>;

[[gnu::noipa]] Pair there_and_back(const Pair& x) {
  return {double{static_cast<float>(x[0])}, double{static_cast<float>(x[1])}};
}

[[gnu::noipa]] Pair by_way_of_memory(const Pair& x, std::array<float, 2>& kept) {
  kept[0] = static_cast<float>(x[0]);
  kept[1] = static_cast<float>(x[1]);
  return {kept[0], kept[1]};
}

[[gnu::noipa]] Pair in_the_middle(const Pair& x) {
  const auto a = static_cast<float>(x[0] * 3), b = static_cast<float>(x[1] * 3);
  return {double{a} + 1, double{b} + 1};
}

// A tenth and a fifth, rounded to 24 bits: 13421773 / 2^27 and 2^26.
constexpr double tenth = 13421773 * 0x1p-27, fifth = 13421773 * 0x1p-26;

TEST(Rounding, OfPairs) {
  EXPECT_EQ(there_and_back({0.1, 0.2}), (Pair{tenth, fifth}));
  std::array<float, 2> kept{};
  EXPECT_EQ(by_way_of_memory({0.1, 0.2}, kept), (Pair{tenth, fifth}));
  EXPECT_EQ(kept, (std::array<float, 2>{0.1f, 0.2f}));
  EXPECT_EQ(in_the_middle({0.1 / 3, 0.2 / 3}), (Pair{1 + tenth, 1 + fifth}));
}

}  // namespace
}  // namespace pse
