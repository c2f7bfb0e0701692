// The promise of DESIGN.md section 4: compiled code gives the interpreter's bits, NaN included, at
// every width and on every processor level. Random modules over all operators, as written and after
// the passes. PSE_AGREE_SEEDS=n in the environment tries n modules on all machines instead of the
// usual sample.
#include <gtest/gtest.h>

#include <cstdlib>

#include "codegen/kernel.h"
#include "codegen/target.h"
#include "support/random_ir.h"

namespace pse {
namespace {

constexpr std::int64_t samples = 45;

struct Result {
  std::vector<std::vector<float>> outputs;
  std::int32_t failed_check = -1;
  std::uint32_t failed_sample = 0;
};

// What test::random_externals does, as the host of a kernel does it.
void call_external(void* user, std::int64_t count, const float* const* arguments,
                   float* const* results) {
  const bool first = user == nullptr;
  for (std::int64_t s = 0; s < count; ++s) {
    if (first) {
      results[0][s] = arguments[0][s] * 0.5f + arguments[1][s];
    } else {
      results[0][s] = arguments[0][s] + 1.0f;
      results[1][s] = arguments[0][s] * arguments[0][s];
    }
  }
}

Result run(const Kernel& kernel, const passes::SplitModule& split, std::uint64_t seed) {
  const ir::Module& module = split.module;
  test::Dice dice(seed);
  const auto padded = static_cast<std::size_t>((samples + 15) / 16 * 16);
  std::vector<std::vector<float>> columns;
  FrameState state;
  state.uniforms.resize(module.inputs.size());
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    columns.emplace_back(padded);
    if (i >= split.first_slot) continue;
    state.uniforms[i] = dice.floating();
    for (float& value : columns[i]) value = dice.floating();
  }
  int second = 0;
  state.externals = {{&call_external, nullptr}, {&call_external, &second}};

  Result result;
  result.outputs.assign(module.outputs.size(), std::vector<float>(padded, 77.0f));
  std::vector<const float*> inputs;
  std::vector<float*> outputs;
  for (const auto& column : columns) inputs.push_back(column.data());
  for (auto& column : result.outputs) outputs.push_back(column.data());
  RunStatus status;
  Scratch scratch;
  kernel.run_frame(state, status);
  if (status.failed_check < 0)
    kernel.run_samples(state, status, scratch, inputs.data(), outputs.data(), samples);
  result.failed_check = status.failed_check;
  result.failed_sample = status.failed_sample;
  return result;
}

struct Machine {
  std::string cpu;
  int width;
};
// In the place of a processor level: the first tier's kernel, which costs so little that it
// takes more modules than the others.
const Machine first_tier{"first tier", 8};
bool has_first_tier() { return host_target() && host_target()->avx2; }

std::vector<Machine> machines() {
  std::vector<Machine> result;
  for (const Target& target : targets) {
    if (!host_target() || &target > host_target()) continue;
    for (const int width : {1, 4, 8, 16, 32}) result.push_back({std::string(target.name), width});
  }
  return result;
}

void compare(const passes::SplitModule& split, const Machine& machine, bool optimize,
             std::uint64_t seed) {
  CodegenOptions options;
  const bool first = machine.cpu == first_tier.cpu;
  options.cpu = first ? "" : machine.cpu;
  options.width = machine.width;
  options.optimize = optimize;
  options.compile_frame = !first && seed % 4 != 0;  // else interpreted, as a short frame is
  const auto kernel = first ? make_first_kernel(split, options) : compile_kernel(split, options);
  ASSERT_TRUE(kernel) << kernel.error();
  const auto shared = std::make_shared<const passes::SplitModule>(split);
  const Result expected = run(*make_interpreted_kernel(shared), split, seed),
               found = run(**kernel, split, seed);
  const std::string where =
      "seed " + std::to_string(seed) + " on " + machine.cpu + " x" + std::to_string(machine.width);
  if (expected.failed_check >= 0 || found.failed_check >= 0) {
    // Which of several failing checks is met first depends on how many samples run side by side.
    EXPECT_EQ(expected.failed_check >= 0, found.failed_check >= 0) << where;
    if (machine.width == 1) {
      EXPECT_EQ(expected.failed_check, found.failed_check) << where;
      EXPECT_EQ(expected.failed_sample, found.failed_sample) << where;
    }
    return;
  }
  for (std::size_t o = 0; o < expected.outputs.size(); ++o) {
    for (std::size_t s = 0; s < samples; ++s) {
      const auto a = std::bit_cast<std::uint32_t>(expected.outputs[o][s]);
      const auto b = std::bit_cast<std::uint32_t>(found.outputs[o][s]);
      if (a == b) continue;
      ADD_FAILURE() << where << ": output " << o << " of sample " << s << " is " << std::hex << b
                    << ", not " << a;
      return;
    }
  }
}

passes::SplitModule unsplit(ir::Module module) {
  passes::SplitModule split;
  split.first_slot = static_cast<std::uint32_t>(module.inputs.size());
  split.frame = static_cast<std::uint32_t>(module.functions.size());
  ir::Function frame;
  frame.name = "frame";
  frame.arrays = module.main().arrays;
  module.functions.push_back(std::move(frame));
  split.module = std::move(module);
  return split;
}

test::RandomIrOptions shape(std::uint64_t seed) {
  test::RandomIrOptions options;
  options.checks = seed % 4 == 0;
  options.instructions = seed % 8 == 1 ? 120 : 40;
  return options;
}

class Agree : public ::testing::TestWithParam<int> {};

TEST_P(Agree, KernelsGiveTheInterpretersBits) {
  const char* wanted = std::getenv("PSE_AGREE_SEEDS");
  const int count = wanted ? std::atoi(wanted) : 6;
  for (int i = 0; has_first_tier() && i < 200; ++i) {
    const auto seed = static_cast<std::uint64_t>(1000 * GetParam() + i);
    compare(unsplit(test::random_module(seed, shape(seed))), first_tier, true, seed);
    compare(passes::run_pipeline(test::random_module(seed, shape(seed))), first_tier, true, seed);
    if (HasFailure()) return;
  }
  const std::vector<Machine> all = machines();
  for (int i = 0; i < count; ++i) {
    const auto seed = static_cast<std::uint64_t>(1000 * GetParam() + i);
    const ir::Module module = test::random_module(seed, shape(seed));
    const passes::SplitModule plain = unsplit(module), optimized = passes::run_pipeline(module);
    for (std::size_t m = 0; m < all.size(); ++m) {
      if (!wanted && (m + seed) % 7 != 0) continue;
      compare(plain, all[m], seed % 5 != 0, seed);
      compare(optimized, all[m], seed % 5 != 0, seed);
      if (HasFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Blocks, Agree, ::testing::Range(0, 8));

}  // namespace
}  // namespace pse
