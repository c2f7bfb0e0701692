// Which programs have loops that samples leave at different turns, and how many samples their
// vectors take unless told.
#include "codegen/uniformity.h"
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

// Adds x to itself `turns` times: a number, or the input x itself; many more operations follow.
std::shared_ptr<const passes::SplitModule> sums(bool turns_vary, int more = 0) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value x = program.input();
  const ir::Value turns = turns_vary ? b.emit(Op::f2i, {x}) : b.const_i32(9);
  ir::Value sum = program.counted_loop(turns, {b.const_f32(0)}, [&](const auto& now) {
    return TestProgram::Carried{b.emit(Op::fadd, {now[0], x})};
  })[0];
  for (int i = 0; i < more; ++i) sum = b.emit(Op::fmul, {sum, x});
  program.output(sum);
  program.finish();
  return std::make_shared<const passes::SplitModule>(program.split);
}

TEST(Width, LoopsVaryWhereTheirTurnsDependOnTheSample) {
  EXPECT_FALSE(has_varying_loops(*sums(false)));
  EXPECT_TRUE(has_varying_loops(*sums(true)));
}

TEST(Width, TwoVectorsAtATimeWhereLoopsVary) {
  const Target* target = host_target();
  if (!target || !target->avx2) GTEST_SKIP() << "a processor without AVX2";
  CodegenOptions options;
  const auto width = [&](bool turns_vary) {
    const auto kernel = compile_kernel(*sums(turns_vary, 400), options);
    return kernel ? (*kernel)->width() : 0;
  };
  EXPECT_EQ(width(false), target->width);
  EXPECT_EQ(width(true), 2 * target->width);
}

}  // namespace
}  // namespace pse::testing_support
