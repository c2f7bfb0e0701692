// The path changes no output of any program, and differs where ways differ.
#include "antialias/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "antialias/derive.h"
#include "ir/interpreter.h"
#include "ir/verifier.h"
#include "passes/passes.h"
#include "picture.h"
#include "support/random_program.h"

namespace pse::antialias {
namespace {

int count_programs() {
  const char* count = std::getenv("PSE_RANDOM_PROGRAMS");
  return std::min(count ? std::atoi(count) : 300, 1000);
}

TEST(Path, OutputsOfRandomProgramsKeepTheirBitsAndEdgesOfAllAreValid) {
  int with_jumps = 0, with_ends = 0;
  for (int seed = 0; seed < count_programs(); ++seed) {
    const pse::test::RandomProgram random(static_cast<std::uint64_t>(seed));
    CompiledFront front;
    try {
      front = test::lowered(random.text());
    } catch (const std::runtime_error& error) {
      FAIL() << error.what();
    }
    passes::remove_dead(front.module);
    ir::Module plain = front.module;
    const Decisions decisions = find_decisions(front.module);
    with_jumps += decisions.any ? 1 : 0;
    ir::Module edges = front.module, path = front.module;
    add_path(path, decisions);
    remove_checks(edges);
    derive_edges(edges, decisions);
    ASSERT_TRUE(ir::verify(path).empty()) << ir::verify(path).front() << "\n" << random.text();
    ASSERT_TRUE(ir::verify(edges).empty()) << ir::verify(edges).front() << "\n" << random.text();
    for (int k = 0; k < 3; ++k) {
      std::vector<float> inputs;
      for (std::size_t i = 0; i < plain.inputs.size(); ++i)
        inputs.push_back(
            static_cast<float>((seed * 7 + k * 13 + static_cast<int>(i) * 5) % 23) / 7.0f - 1.3f);
      const auto a = ir::interpret(plain, plain.entry, inputs, nullptr, 100000);
      const auto b = ir::interpret(path, path.entry, inputs, nullptr, 100000);
      ASSERT_EQ(static_cast<int>(a.outcome.end), static_cast<int>(b.outcome.end));
      if (a.outcome.end != ir::End::finished) continue;
      const std::size_t own = a.results.size();
      const auto has = [&](const char* name) {
        return std::ranges::find(path.outputs, name, &ir::Output::name) != path.outputs.end();
      };
      const bool has_ends = has(ends_name);
      with_ends += has_ends ? 1 : 0;
      ASSERT_EQ(own + 1 + has_ends + has(fine_name) + has(bent_name), b.results.size());
      EXPECT_TRUE(std::equal(a.results.begin(), a.results.end(), b.results.begin()))
          << random.text();
      const float value = ir::to_f32(b.results[own]);
      EXPECT_TRUE(!has_ends || std::isfinite(ir::to_f32(b.results[own + 1]))) << random.text();
      EXPECT_TRUE(value >= 0 && value < 16777216 && value == std::floor(value));
    }
  }
  EXPECT_GT(with_jumps, count_programs() / 4);
  if (count_programs() >= 50) {
    EXPECT_GT(with_ends, 0);
  }
}

struct Way {
  float path, ends;
};

// ends: 0 where the program has none.
Way way_at(const std::string& text, float x) {
  CompiledFront front = test::lowered(text);
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  const std::size_t own = front.module.outputs.size();
  add_path(front.module, decisions);
  const std::vector<float> inputs(front.module.inputs.size(), x);
  const auto results = ir::interpret(front.module, front.module.entry, inputs).results;
  return {ir::to_f32(results[own]), results.size() > own + 1 ? ir::to_f32(results[own + 1]) : 0};
}
float path_at(const std::string& text, float x) { return way_at(text, x).path; }

TEST(Path, DiffersWhereAnOutcomeDiffers) {
  for (const auto& [text, a, b] :
       {std::tuple("c = select(x < 1, 2, 3)\n", 0.5f, 1.5f),
        std::tuple("c = floor(x)\n", 0.5f, 1.5f), std::tuple("c = floor(x)\n", -1.5f, 3.5f),
        std::tuple("c = round(x)\n", 0.4f, 0.6f), std::tuple("c = mod(x, 2)\n", 1.5f, 2.5f),
        std::tuple("c = x\nwhile c < 9\n    c += 1\n", 3.5f, 4.5f),
        std::tuple("c = 0\nfor i in [1 .. 4]\n    if i < x\n        c += 1\n", 2.5f, 3.5f),
        std::tuple("function f(p)\n    if p < 1\n        return 0\n    return p\nc = f(x)\n", 0.5f,
                   1.5f)})
    EXPECT_NE(path_at(text, a), path_at(text, b)) << text;
  EXPECT_EQ(path_at("c = floor(x) + Noise(x, x)\n", 1.2f),
            path_at("c = floor(x) + Noise(x, x)\n", 1.7f));
  // Outcomes that swap between turns are another path.
  const char* swapped =
      "c = 0\nfor i in [1 .. 2]\n    if (x - 1.5) * (i - 1.5) > 0\n        c += i\n";
  EXPECT_NE(path_at(swapped, 1), path_at(swapped, 2));
}

// A ray from (x, 0) along y to a disc of radius 2 around (0, 4), or to a wall behind it.
const std::string march = R"(
function scene(p)
    return min(norm(p - [0 4]) - 2, 9 - p.y)
t = 0
for i in [1 .. 200]
    d = scene([x t])
    t += d
    if d < 0.0001 break
c = t
)";

TEST(Path, SearchesCountByWhatTheyEndWith) {
  // Of the disc, whose distance is 4 - sqrt(4 - x^2): 2 and 2.2679; the turns differ.
  const Way middle = way_at(march, 0), beside = way_at(march, 1);
  EXPECT_EQ(middle.path, beside.path);
  EXPECT_GT(middle.ends, 0);
  // The piecewise logarithm of 1 + t grows by (3.2679 - 3) / 2, times a weight from 1 to 2.
  const float growth = beside.ends - middle.ends;
  EXPECT_GT(growth, 0.133f);
  EXPECT_LT(growth, 0.269f);
  // The wall: another outcome of the last turn, and ends that jump, from 1 + 4 to 1 + 9.
  const Way hit = way_at(march, 1.999f), miss = way_at(march, 2.001f);
  EXPECT_NE(hit.path, miss.path);
  EXPECT_GT(miss.ends - hit.ends, 0.9f);
}

TEST(Path, ALoopWhoseTurnsAreCountedIsNoSearch) {
  for (const char* text :
       {"c = x\nwhile c < 9\n    c += 1\n", "z = x\nc = 0\nwhile z < 9\n    z *= 1.5\n    c += 1\n",
        "z = x\nc = 0\nfor i in [1 .. 50]\n    z *= 1.5\n    c = i\n"
        "    if z > 9 break\n",
        // What stands in an array is not among what it ends with.
        "_a = array(20)\n_z = x\n_i = 0\nwhile _z < 9\n    _i += 1\n"
        "    _a[_i] = _z\n    _z *= 1.5\nc = _a[2] + _z\n"}) {
    EXPECT_EQ(way_at(text, 2.5f).ends, 0) << text;
    EXPECT_NE(path_at(text, 2.5f), path_at(text, 6.5f)) << text;
  }
  // Nothing of it is seen but where it ends.
  EXPECT_NE(way_at("z = x\nwhile z < 9\n    z *= 1.5\nc = z\n", 2.5f).ends, 0);
}

// Its turns hand nothing on but whether one of them has met its condition: each is an edge.
TEST(Path, ALoopThatLeavesAtTheFirstIsNoSearch) {
  for (const char* text : {"c = 0\nfor i in [1 .. 3]\n    if x > i\n        c = 1\n        break\n",
                           "function f(t)\n    for i in [1 .. 3]\n        if t > 7 - 2 * i\n"
                           "            return t\n    return 0\nc = f(x)\n",
                           "c = 1\nz = x\nwhile z < 1\n    z = 2\n    c = 0\n"}) {
    EXPECT_EQ(way_at(text, 3.5f).ends, 0) << text;
    EXPECT_NE(path_at(text, 3.5f), path_at(text, 0.5f)) << text;
  }
}

TEST(Path, BendsLeaveTheBitsOfJumps) {
  constexpr int jumps = (1 << bits_of_jumps) - 1;
  const auto bits = [](const char* text, float x) { return int(path_at(text, x)) & jumps; };
  EXPECT_EQ(bits("c = max(x, 1)\n", 0), bits("c = max(x, 1)\n", 2));
  EXPECT_NE(path_at("c = max(x, 1)\n", 0), path_at("c = max(x, 1)\n", 2));
  EXPECT_NE(bits("c = select(x < 1, 2, 3)\n", 0), bits("c = select(x < 1, 2, 3)\n", 2));
}

// What only a jump is computed from is seen by that jump alone; the same number shown is a bend.
TEST(Path, BendsCountOnlyWhereAnOutputShowsThem) {
  for (const char* text :
       {"c = floor(max(x, 1) / 4)\n", "_m = min(x, 1)\nc = 0\nif _m > 0.7\n    c = 1\n",
        "c = mod(floor(min(x, 1) / 8 + 3), 2)\n"})
    EXPECT_EQ(path_at(text, 0.8f), path_at(text, 1.2f)) << text;
  EXPECT_EQ(path_at("c = select(min(x, 1) < 0.5, 2, 3)\n", 0.8f),
            path_at("c = select(min(x, 1) < 0.5, 2, 3)\n", 1.2f));
  EXPECT_NE(path_at("c = select(min(x, 1) < 0.5, 2, 3)\n", 0.4f),
            path_at("c = select(min(x, 1) < 0.5, 2, 3)\n", 0.6f));
  for (const char* text : {"_m = min(x, 1)\nc = select(_m < 0.5, _m, 3)\n",
                           "c = 0\nif min(x, 1) > 0.7\n    c = x\nc += max(x, 1)\n",
                           "_a = array(3)\n_a[1] = min(x, 1)\nc = _a[1]\n",
                           "_m = min(x, 1)\nfor i in [1 .. 5]\n    _m = _m * _m\nc = _m\n"})
    EXPECT_NE(path_at(text, 0.8f), path_at(text, 1.2f)) << text;
}

// A step that only one branch looks at, to choose a random number, is none elsewhere. One that
// decides there is, for the branch may lie between two samples.
TEST(Path, WhatOneBranchUsesDecidesThere) {
  const char* random =
      "_s = 1 + floor(x / 4)\n_k = floor(8 * x * _s)\nc = 0\nif x > 5\n    c = hash(_k, _s)\n";
  EXPECT_EQ(path_at(random, 0.1f), path_at(random, 4.9f));
  EXPECT_NE(path_at(random, 5.1f), path_at(random, 5.9f));
  EXPECT_NE(path_at(random, 4.9f), path_at(random, 5.1f));
  for (const char* text :
       {"_k = floor(8 * x)\nc = 0\nif x > 5\n    c = mod(_k, 3) > 0.5 ? 1 : 0\n",
        "_k = floor(8 * x)\nc = hash(_k)\nif x > 5\n    c += hash(_k, 1)\n",
        "_k = floor(8 * x)\nc = 0\nif x > 5\n    c = hash(_k)\nelse\n    c = hash(_k, 2)\n",
        "_b = x < 2\nc = 0\nif x > 5 and _b\n    c = 1\n"})
    EXPECT_NE(path_at(text, 0.1f), path_at(text, 4.9f)) << text;
}

}  // namespace
}  // namespace pse::antialias
