// What only the first tier has to get right: registers that are given to other values, rows of the
// frame that are used again, and what loops and branches keep in them.
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

const Machine first{8, first_tier};

class FirstTier : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!host_target() || !host_target()->avx2) GTEST_SKIP() << "a processor without AVX2";
  }
};

// Sample s of column c.
float numbered(std::size_t c, std::size_t s) { return static_cast<float>(100 * c + s); }

Columns numbered_columns(std::size_t columns, std::size_t count) {
  Columns result(columns);
  for (std::size_t c = 0; c < columns; ++c)
    for (std::size_t s = 0; s < count; ++s) result[c].push_back(numbered(c, s));
  return result;
}

// Forty values live at once, used in the order they came and in the opposite one: most are stored
// and loaded again, and rows are free in an order of their own.
TEST_F(FirstTier, MoreValuesThanRegisters) {
  TestProgram program;
  std::vector<ir::Value> values;
  for (int i = 0; i < 40; ++i) {
    const ir::Value in = program.input();
    values.push_back(program.build.emit(Op::fadd, {in, program.build.const_f32(1)}));
  }
  for (std::size_t i = 0; i < 20; ++i)
    program.output(program.build.emit(Op::fsub, {values[i], values[39 - i]}));
  for (std::size_t i = 40; i-- > 20;) {
    const ir::Value twice = program.build.emit(Op::fadd, {values[i], values[i]});
    program.output(program.build.emit(Op::fmul, {twice, values[i - 20]}));
  }
  program.finish();
  const Columns out = run(program, first, numbered_columns(40, 11), 11);
  for (std::size_t s = 0; s < 11; ++s) {
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_EQ(out[i][s], numbered(i, s) - numbered(39 - i, s));
      const float large = numbered(39 - i, s) + 1, small = numbered(19 - i, s) + 1;
      EXPECT_EQ(out[20 + i][s], 2 * large * small);
    }
  }
}

// The fused operation overwrites a register: whichever operands are needed again keep theirs.
TEST_F(FirstTier, FusedOperationsSpareWhatIsNeededAgain) {
  TestProgram program;
  const ir::Value a = program.input(), b = program.input(), c = program.input();
  const auto fma = [&](ir::Value x, ir::Value y, ir::Value z) {
    return program.build.emit(Op::fma, {x, y, z});
  };
  const ir::Value all = fma(a, b, c), square = fma(a, a, a), product = fma(b, c, b),
                  constant = fma(program.build.const_f32(2), a, program.build.const_f32(3));
  for (const ir::Value value : {all, square, product, constant, fma(a, b, a), fma(c, c, b)})
    program.output(value);
  program.finish();
  const Columns out = run(program, first, {{2, 3}, {5, 7}, {11, 13}}, 2);
  const Columns expected = {{21, 34}, {6, 12}, {60, 98}, {7, 9}, {12, 24}, {126, 176}};
  EXPECT_EQ(out, expected);
}

// A loop that hands its values on in a circle, for a different number of turns in each lane: the
// rows of the next turn must not be read after they are written.
TEST_F(FirstTier, LoopsThatExchangeTheirValues) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value turns = b.emit(Op::f2i, {program.input()});
  const ir::Value one = b.const_f32(1), two = b.const_f32(2), three = b.const_f32(3);
  const auto results = program.counted_loop(turns, {one, two, three}, [](const auto& now) {
    return TestProgram::Carried{now[1], now[2], now[0]};
  });
  for (const ir::Value result : results) program.output(result);
  program.finish();
  const Columns out = run(program, first, {{0, 1, 2, 3, 4, 5, 6, 7, 100}}, 9);
  for (std::size_t s = 0; s < 9; ++s) {
    const std::size_t shift = s == 8 ? 100 : s;
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(out[i][s], static_cast<float>((i + shift) % 3 + 1)) << "sample " << s;
  }
}

// A value from before a loop that is last used in its first instruction is needed in every turn,
// whatever else the turn puts into rows and registers.
TEST_F(FirstTier, ValuesFromOutsideLastThroughALoop) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value turns = b.emit(Op::f2i, {program.input()});
  const ir::Value outer = b.emit(Op::fadd, {program.input(), b.const_f32(0.5f)});
  const auto results = program.counted_loop(turns, {b.const_f32(0)}, [&](const auto& sum) {
    ir::Value value = b.emit(Op::fadd, {sum[0], outer});
    // Twenty more that are alive together.
    std::vector<ir::Value> others;
    for (int i = 0; i < 20; ++i)
      others.push_back(b.emit(Op::fmul, {value, b.const_f32(static_cast<float>(i))}));
    for (const ir::Value other : others)
      value = b.emit(Op::fadd, {value, b.emit(Op::fsub, {other, other})});
    return TestProgram::Carried{value};
  });
  program.output(results[0]);
  program.finish();
  const Columns out = run(program, first, {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 2, 3, 4, 5, 6, 7, 8}}, 8);
  for (std::size_t s = 0; s < 8; ++s)
    EXPECT_EQ(out[0][s], static_cast<float>(s) * (static_cast<float>(s) + 1.5f));
}

// Only lanes that both branches let in: what the inner one asks the host for is counted.
TEST_F(FirstTier, ABranchWithinABranchKeepsToItsLanes) {
  TestProgram program;
  ir::Builder& b = program.build;
  program.split.module.externals = {{"seen", 1, 1}};
  const ir::Value x = program.input(), y = program.input(), zero = b.const_f32(0);
  ir::Region inner, outer, nothing, none;
  const ir::Value outside = b.emit(Op::flt, {zero, x}), inside = b.emit(Op::flt, {zero, y});
  b.begin_region(outer);
  b.begin_region(inner);
  const ir::Value seen = b.emit_multi(Op::external, std::vector<ir::Value>{x},
                                      std::vector<ir::Type>{ir::Type::f32}, 0)[0];
  b.end_region();
  inner.yields = {seen};
  none.yields = nothing.yields = {zero};
  outer.yields = {b.emit_if(inside, std::move(inner), std::move(none))[0]};
  b.end_region();
  program.output(b.emit_if(outside, std::move(outer), std::move(nothing))[0]);
  program.finish();
  const auto kernel = compile(program, first);
  ASSERT_TRUE(kernel);
  std::vector<float> asked;
  Runner once;
  once.state.externals = {
      {[](void* user, std::int64_t count, const float* const* in, float* const* out) {
         auto& list = *static_cast<std::vector<float>*>(user);
         list.insert(list.end(), in[0], in[0] + count);
         for (std::int64_t i = 0; i < count; ++i) out[0][i] = 2 * in[0][i];
       },
       &asked}};
  const Columns out = once(*kernel, program.split.module, {0, 0},
                           {{1, -2, 3, 4, -5, 6, 7, 8}, {1, 1, -1, 1, 1, -1, -1, 1}}, 8);
  EXPECT_EQ(asked, (std::vector<float>{1, 4, 8}));
  EXPECT_EQ(out[0], (std::vector<float>{2, 0, 0, 8, 0, 0, 0, 16}));
}

}  // namespace
}  // namespace pse::testing_support
