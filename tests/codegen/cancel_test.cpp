// How a run is stopped, without a clock: nothing begins any more once the flag is set, whether it
// is the run's own or that of the run around it, and nobody waits for LLVM.
#include <future>
#include <thread>

#include "codegen/frame_code.h"
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

class Cancel : public OnEveryMachine {};

// Code without a loop, whose samples are stopped one vector from the next.
TEST_P(Cancel, NoVectorOfSamplesBeginsOnceStopped) {
  TestProgram program;
  program.output(program.build.emit(ir::Op::fadd, {program.input(), program.build.const_f32(1)}));
  program.finish();
  const auto kernel = compile(program, GetParam());
  const auto interpreted =
      make_interpreted_kernel(std::make_shared<const passes::SplitModule>(program.split));
  ASSERT_TRUE(kernel);
  for (const Kernel* each : {kernel.get(), interpreted.get()}) {
    const std::int64_t count = 200 + GetParam().width / 2;  // and a last vector that is not full
    RunStatus around;
    around.cancel = true;
    for (const RunStatus* outer : {static_cast<const RunStatus*>(nullptr),
                                   static_cast<const RunStatus*>(&around)}) {
      Runner once;
      once.status.cancel = outer == nullptr;
      once.status.outer = outer;
      const Columns out = once(*each, program.split.module, {0},
                               {std::vector<float>(static_cast<std::size_t>(count), 1.0f)}, count);
      int computed = 0;
      for (const float value : out[0]) computed += value == 2.0f ? 1 : 0;
      EXPECT_LE(computed, each->width());
    }
    Runner free;
    EXPECT_EQ(free(*each, program.split.module, {0},
                   {std::vector<float>(static_cast<std::size_t>(count), 1.0f)}, count)[0][0],
              2.0f);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Cancel, ::testing::ValuesIn(all_machines()), machine_name);

TEST(CancelInside, AnInnerRunFollowsTheRunAround) {
  RunStatus around, inner{.outer = &around}, innermost{.outer = &inner};
  innermost.cancel = true;  // by itself it cannot be stopped
  EXPECT_FALSE(innermost.stopped());
  around.cancel = true;
  EXPECT_TRUE(innermost.stopped());
  EXPECT_EQ(&innermost.stop(), &around.cancel);
}

TEST(CancelInside, NobodyWaitsForTheFramesCompilation) {
  TestProgram program;
  program.finish();
  std::promise<void> begun, go_on;
  const auto compile_until_told = [&](const passes::SplitModule&) -> std::optional<CodeObject> {
    begun.set_value();
    go_on.get_future().wait();
    return std::nullopt;
  };
  const FrameCode frame(program.split, compile_until_told, true);
  FrameState state;
  RunStatus status;
  std::jthread canceller([&] {
    begun.get_future().wait();
    status.cancel = true;
  });
  frame.run(state, status);  // comes back although the compilation has not ended
  EXPECT_TRUE(status.cancel);
  go_on.set_value();
}

}  // namespace
}  // namespace pse::testing_support
