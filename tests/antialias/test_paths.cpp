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
  int with_jumps = 0;
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
        inputs.push_back(static_cast<float>((seed * 7 + k * 13 + static_cast<int>(i) * 5) % 23) /
                             7.0f -
                         1.3f);
      const auto a = ir::interpret(plain, plain.entry, inputs, nullptr, 100000);
      const auto b = ir::interpret(path, path.entry, inputs, nullptr, 100000);
      ASSERT_EQ(static_cast<int>(a.outcome.end), static_cast<int>(b.outcome.end));
      if (a.outcome.end != ir::End::finished) continue;
      ASSERT_EQ(a.results.size() + 1, b.results.size());
      EXPECT_TRUE(std::equal(a.results.begin(), a.results.end(), b.results.begin()))
          << random.text();
      const float value = ir::to_f32(b.results.back());
      EXPECT_TRUE(value >= 0 && value < 16777216 && value == std::floor(value));
    }
  }
  EXPECT_GT(with_jumps, count_programs() / 4);
}

float path_at(const std::string& text, float x) {
  CompiledFront front = test::lowered(text);
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  add_path(front.module, decisions);
  std::vector<float> inputs(front.module.inputs.size(), x);
  return ir::to_f32(ir::interpret(front.module, front.module.entry, inputs).results.back());
}

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
  const char* swapped = "c = 0\nfor i in [1 .. 2]\n    if (x - 1.5) * (i - 1.5) > 0\n        c += i\n";
  EXPECT_NE(path_at(swapped, 1), path_at(swapped, 2));
}

}  // namespace
}  // namespace pse::antialias
