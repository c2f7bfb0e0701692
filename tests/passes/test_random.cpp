// Every pass, and all of them, keep the meaning of random modules bit for bit.
#include <gtest/gtest.h>

#include <functional>

#include "../support/random_ir.h"
#include "../support/run_ir.h"
#include "ir/text.h"
#include "ir/verifier.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

constexpr int modules = 800;
constexpr int samples = 4;

test::RandomIrOptions options_of(std::uint64_t seed) {
  test::RandomIrOptions options;
  options.instructions = 20 + static_cast<int>(seed % 5) * 20;
  options.checks = seed % 4 == 0;
  options.arrays = seed % 3 != 0;
  return options;
}

std::string first_complaint(const ir::Module& module) {
  const auto complaints = ir::verify(module);
  return complaints.empty() ? "" : complaints.front();
}

// Runs `pass` on random modules and compares with the module as it was.
void expect_same_meaning(const std::function<void(ir::Module&)>& pass, std::uint64_t first_seed) {
  for (std::uint64_t seed = first_seed; seed < first_seed + modules; ++seed) {
    const ir::Module before = test::random_module(seed, options_of(seed));
    ir::Module after = before;
    pass(after);
    ASSERT_EQ(first_complaint(after), "") << "seed " << seed << "\n"
                                          << ir::print(before) << ir::print(after);
    for (int sample = 0; sample < samples; ++sample) {
      const auto inputs =
          test::random_inputs(before, seed * 100 + static_cast<std::uint64_t>(sample));
      const auto expected = test::run_module(before, inputs, &test::random_externals());
      const auto actual = test::run_module(after, inputs, &test::random_externals());
      ASSERT_EQ(actual, expected) << "seed " << seed << "\n"
                                  << ir::print(before) << "\nbecame\n"
                                  << ir::print(after);
    }
  }
}

// Runs something that splits, and compares the two functions, one after the other, with the module
// as it was.
void expect_same_split(const std::function<SplitModule(ir::Module)>& cut,
                       std::uint64_t first_seed) {
  for (std::uint64_t seed = first_seed; seed < first_seed + modules; ++seed) {
    const ir::Module before = test::random_module(seed, options_of(seed));
    const SplitModule after = cut(before);
    ASSERT_EQ(first_complaint(after.module), "") << "seed " << seed << "\n"
                                                 << ir::print(before) << "\nbecame\n"
                                                 << ir::print(after.module);
    for (int sample = 0; sample < samples; ++sample) {
      const auto inputs =
          test::random_inputs(before, seed * 100 + static_cast<std::uint64_t>(sample));
      const auto expected = test::run_module(before, inputs, &test::random_externals());
      const auto actual = test::run_split(after, inputs, &test::random_externals());
      ASSERT_EQ(actual, expected) << "seed " << seed << "\n"
                                  << ir::print(before) << "\nbecame\n"
                                  << ir::print(after.module);
    }
  }
}

TEST(RandomModules, RemoveDeadKeepsMeaning) {
  expect_same_meaning([](ir::Module& m) { remove_dead(m); }, 10'000);
}
TEST(RandomModules, InlineKeepsMeaning) {
  expect_same_meaning([](ir::Module& m) { inline_calls(m); }, 20'000);
}
TEST(RandomModules, FoldKeepsMeaning) { expect_same_meaning(fold, 30'000); }
TEST(RandomModules, ShareKeepsMeaning) { expect_same_meaning(share, 40'000); }
TEST(RandomModules, SimplifyLoopsKeepsMeaning) { expect_same_meaning(simplify_loops, 50'000); }
TEST(RandomModules, ConvertIfsKeepsMeaning) {
  expect_same_meaning([](ir::Module& m) { convert_ifs(m); }, 60'000);
}
TEST(RandomModules, UnrollKeepsMeaning) {
  expect_same_meaning([](ir::Module& m) { unroll(m, {.max_instructions = 400}); }, 130'000);
}
TEST(RandomModules, DecideKeepsMeaning) { expect_same_meaning(decide, 140'000); }
TEST(RandomModules, HoistKeepsMeaning) { expect_same_meaning(hoist, 70'000); }
TEST(RandomModules, HoistFrameKeepsMeaning) {
  expect_same_meaning(
      [](ir::Module& m) {
        assign_rates(m);
        hoist_frame(m);
      },
      80'000);
}
TEST(RandomModules, SplitKeepsMeaning) { expect_same_split(split, 90'000); }
TEST(RandomModules, SplitNothingKeepsMeaning) { expect_same_split(split_nothing, 100'000); }
TEST(RandomModules, PipelineKeepsMeaning) {
  expect_same_split([](ir::Module m) { return run_pipeline(std::move(m)); }, 110'000);
}
TEST(RandomModules, PipelineWithoutOptimisationKeepsMeaning) {
  expect_same_split([](ir::Module m) { return run_pipeline(std::move(m), {.optimize = false}); },
                    120'000);
}

TEST(RandomModules, EveryStepOfThePipelineIsValid) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    run_pipeline(test::random_module(seed, options_of(seed)),
                 {.after_pass = [&](std::string_view pass, const ir::Module& module) {
                   ASSERT_EQ(first_complaint(module), "") << "seed " << seed << " after " << pass;
                 }});
  }
}

}  // namespace
}  // namespace pse::passes
