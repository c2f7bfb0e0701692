// Expectations that a host reports: noted at the same pixels by every machine, and of no influence
// on the picture or on what is taken for an edge.
#include <gtest/gtest.h>

#include "antialias/path.h"
#include "ir/expectations.h"
#include "passes/passes.h"
#include "picture.h"

namespace pse::antialias {
namespace {

using test::Picture;
using test::PictureOptions;

using Noted = std::set<std::pair<float, float>>;

// Of the places, the centres of the picture's pixels.
Noted at_centres(const Noted& noted, int width, int height) {
  Noted centres;
  for (const auto& [x, y] : noted)
    if (x - std::floor(x) == 0.5f && y - std::floor(y) == 0.5f && x > 0 && y > 0 &&
        x < static_cast<float>(width) && y < static_cast<float>(height))
      centres.emplace(x, y);
  return centres;
}

const char* const disc = "c = expect(x * y, x * x + y * y < 0.5, \"outside\")\n";
// A march whose density is none in a part of the picture, with edges of its own.
const char* const march =
    "function rock(p)\n"
    "    if p.x > 0.2 and p.z < 0.3 return 0 / (p.y - p.y)\n"
    "    return 3 * (0.7 - norm(p)) + 0.3 * Noise(4 * p)\n"
    "function shade(p, d)\n    return [d 0.5 p.y > 0 ? 1 : 0]\n"
    "light = raymarch(rock, shade, [x y 1], [0 0 -1], 0, 2, 0.1, 20)\nc = light.r + light.b\n";
// Nested, in a loop and behind a decision.
const char* const loops =
    "function part(q)\n"
    "    s = expect(q * q, q < 0.9, \"large\", part)\n"
    "    return sqrt(s + 1) + sin(3 * s) * cos(2 * s) + Noise(4 * q)\n"
    "c = 0\n"
    "for i in [1 .. 3]\n"
    "    if x > -0.3\n"
    "        c += part(x * i - y)\n"
    "    else\n"
    "        c += floor(4 * part(y + 0.1 * i))\n";

TEST(Expectations, AreNotedWhereTheyFail) {
  Noted expected;
  for (int py = 0; py < 24; ++py)
    for (int px = 0; px < 24; ++px) {
      const double x = (2 * (px + 0.5) - 24) / 24, y = (24 - 2 * (py + 0.5)) / 24;
      if (x * x + y * y >= 0.5)
        expected.emplace(static_cast<float>(px) + 0.5f, static_cast<float>(py) + 0.5f);
    }
  PictureOptions options{.width = 24, .height = 24, .antialias = test::plain(), .reports = true};
  EXPECT_EQ(test::render(disc, options).noted, expected);
  options.antialias = test::procedural();
  options.tile = 7;
  EXPECT_EQ(at_centres(test::render(disc, options).noted, 24, 24), expected);
}

TEST(Expectations, AreNotedByAllMachinesAlike) {
  for (const char* text : {disc, march, loops}) {
    PictureOptions options{.width = 20, .height = 16, .antialias = test::plain(), .reports = true};
    options.interpret = true, options.optimize = false;
    const Noted meant = test::render(text, options).noted;
    EXPECT_FALSE(meant.empty());
    EXPECT_LT(meant.size(), 320u);
    options.optimize = true;
    EXPECT_EQ(test::render(text, options).noted, meant);
    options.interpret = false;
    // Large programs make functions of what they write often.
    for (const std::size_t outline : {std::size_t{0}, std::size_t{900}})
      for (const int width : {1, 4, 8, 16, 32}) {
        options.vector_width = width;
        options.outline.min_total = outline;
        if (outline == 0) options.outline.min_size = options.outline.min_saved = 2;
        EXPECT_EQ(test::render(text, options).noted, meant) << width;
      }
    options.vector_width = 0, options.outline = {};
    for (const Options& antialias : {test::procedural(), test::samples(4)}) {
      options.antialias = antialias;
      for (const int tile : {5, 64}) {
        options.tile = tile, options.threads = tile == 5 ? 2 : 1;
        EXPECT_EQ(at_centres(test::render(text, options).noted, 20, 16), meant) << tile;
      }
    }
  }
}

TEST(Expectations, LeaveThePictureAsItIs) {
  for (const char* text : {disc, march, loops})
    for (const Options& antialias : {test::plain(), test::procedural(), test::samples(3)}) {
      PictureOptions options{.width = 40, .height = 32, .antialias = antialias};
      const Picture without = test::render(text, options);
      EXPECT_TRUE(without.noted.empty());
      options.reports = true;
      const Picture with = test::render(text, options);
      EXPECT_EQ(with.planes, without.planes);
      EXPECT_EQ(with.counts.filtered, without.counts.filtered);
      EXPECT_EQ(with.counts.blended, without.counts.blended);
      EXPECT_EQ(with.counts.supersampled, without.counts.supersampled);
    }
}

// What the conditions compare is no edge, and what a search hands to them is no end of it.
TEST(Expectations, AreNoDecisions) {
  for (const char* text : {disc, march, loops}) {
    ir::Module plain = test::lowered(text).module, told = plain;
    ir::drop_expectations(plain);
    passes::remove_dead(plain);
    passes::remove_dead(told);
    passes::settle_expectations(told);
    const Decisions without = find_decisions(plain), with = find_decisions(told);
    const auto number = [](const std::vector<bool>& list) {
      return std::ranges::count(list, true);
    };
    EXPECT_EQ(number(with.forks), number(without.forks));
    EXPECT_EQ(number(with.bends), number(without.bends));
    EXPECT_EQ(number(with.creases), number(without.creases));
    EXPECT_EQ(number(with.searched), number(without.searched));
    EXPECT_EQ(number(with.ends), number(without.ends));
    EXPECT_GT(number(with.expected), 0);
    EXPECT_EQ(number(without.expected), 0);
    // Nor do they make a second run of each tile, as checks do.
    EXPECT_EQ(has_checks(told), has_checks(plain));
    remove_checks(told);
    EXPECT_FALSE(ir::has_expectations(told));
  }
}

}  // namespace
}  // namespace pse::antialias
