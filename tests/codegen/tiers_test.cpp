// Two tiers behind one kernel: which of them computes, when LLVM's takes over, and that nobody sees
// a difference.
#include <filesystem>
#include <thread>

#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;
namespace fs = std::filesystem;

// 200 x * x by as many additions, so that a call takes its time.
std::shared_ptr<const passes::SplitModule> sums() {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value x = program.input();
  const auto results =
      program.counted_loop(b.const_i32(200), {b.const_f32(0)}, [&](const auto& sum) {
        return TestProgram::Carried{b.emit(Op::fadd, {sum[0], b.emit(Op::fmul, {x, x})})};
      });
  program.output(results[0]);
  program.finish();
  return std::make_shared<const passes::SplitModule>(program.split);
}

class Tiers : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!host_target() || !host_target()->avx2) GTEST_SKIP() << "a processor without AVX2";
    fs::create_directories(options_.cache = fs::temp_directory_path() / "pse_tiers_test");
    for (std::size_t i = 0; i < 1024; ++i) column_.push_back(static_cast<float>(i) * 0.25f);
  }
  void TearDown() override { fs::remove_all(options_.cache); }

  void run_once(const Kernel& kernel) {
    Runner once;
    const Columns out =
        once(kernel, split_->module, std::vector<float>(1), {column_}, std::int64_t{1024});
    for (std::size_t i = 0; i < column_.size(); ++i) {
      float sum = 0;
      for (int turn = 0; turn < 200; ++turn) sum += column_[i] * column_[i];
      ASSERT_EQ(out[0][i], sum);
    }
  }

  std::shared_ptr<const passes::SplitModule> split_ = sums();
  CodegenOptions options_;
  std::vector<float> column_;
};

TEST_F(Tiers, TheFirstAloneStaysAlone) {
  CodegenStats stats;
  const auto kernel = make_kernel(split_, options_, Tier::first, &stats);
  ASSERT_TRUE(kernel);
  EXPECT_TRUE(stats.first_tier);
  for (int i = 0; i < 20; ++i) run_once(**kernel);
  EXPECT_EQ((*kernel)->tier_samples().first, 20 * 1024);
  EXPECT_EQ((*kernel)->tier_samples().optimised, 0);
  EXPECT_FALSE(compiles_behind());
}

TEST_F(Tiers, LlvmTakesOverWhenTheFirstHasWorkedForLong) {
  const auto kernel = make_kernel(split_, options_, Tier::automatic);
  ASSERT_TRUE(kernel);
  // It is bound to come, however slow the machine is.
  while ((*kernel)->tier_samples().optimised == 0) run_once(**kernel);
  const TierSamples runs = (*kernel)->tier_samples();
  EXPECT_GT(runs.first, 0);
  run_once(**kernel);
  EXPECT_EQ((*kernel)->tier_samples().first, runs.first);
  EXPECT_EQ((*kernel)->tier_samples().optimised, runs.optimised + 1024);
}

TEST_F(Tiers, WhatIsCachedComesAtOnce) {
  ASSERT_TRUE(compile_kernel(*split_, options_));
  CodegenStats stats;
  const auto kernel = make_kernel(split_, options_, Tier::automatic, &stats);
  ASSERT_TRUE(kernel);
  EXPECT_TRUE(stats.from_cache);
  EXPECT_FALSE(stats.first_tier);
  run_once(**kernel);
  EXPECT_EQ((*kernel)->tier_samples().first, 0);
}

TEST_F(Tiers, LlvmsKernelIsKeptForTheNextRun) {
  {
    const auto kernel = make_kernel(split_, options_, Tier::automatic);
    ASSERT_TRUE(kernel);
    while ((*kernel)->tier_samples().optimised == 0) run_once(**kernel);
  }
  CodegenStats stats;
  ASSERT_TRUE(make_kernel(split_, options_, Tier::automatic, &stats));
  EXPECT_TRUE(stats.from_cache);
}

TEST_F(Tiers, AKernelMayGoWhileLlvmStillCompilesForIt) {
  for (int i = 0; i < 3; ++i) {
    const auto kernel = make_kernel(split_, options_, Tier::automatic);
    ASSERT_TRUE(kernel);
    while (!compiles_behind() && (*kernel)->tier_samples().optimised == 0) run_once(**kernel);
  }
  while (compiles_behind()) std::this_thread::yield();
}

}  // namespace
}  // namespace pse::testing_support
