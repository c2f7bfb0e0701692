// Rates and the split, on programs whose answer is known.
#include "../support/run_ir.h"
#include "pass_test.h"

namespace pse::passes {
namespace {

using ir::Op;
using ir::Rate;
using test::body_of;
using test::count;
using test::module_of;

Rate rate_of(const ir::Module& module, ir::Value value) { return module.main().values[value].rate; }

TEST(Rates, FollowOperandsAndControl) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = const.f 2
  %3 = fmul %2 %2
  %4 = fmul %1 %2
  %5 = fmul %0 %1
  %6 = flt %0 %2
  %7 = flt %1 %2
  %10:f %11:f = if %6 {
    yield %4 %5
  } else {
    yield %4 %4
  }
  %12:f %13:f = if %7 {
    yield %2 %4
  } else {
    yield %3 %5
  }
  %14:f = external 0 %2
  yield %5
)");
  assign_rates(module);
  EXPECT_EQ(rate_of(module, 3), Rate::constant);
  EXPECT_EQ(rate_of(module, 4), Rate::frame);
  EXPECT_EQ(rate_of(module, 5), Rate::sample);
  EXPECT_EQ(rate_of(module, 10),
            Rate::sample);  // chosen per sample, though both sides give the same
  EXPECT_EQ(rate_of(module, 12), Rate::frame);  // constants chosen per frame
  EXPECT_EQ(rate_of(module, 13), Rate::sample);
  EXPECT_EQ(rate_of(module, 14),
            Rate::frame);  // the host may bring another picture for another frame
}

TEST(Rates, LoopsRaiseWhatTheyCarry) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.i 0
  %2 = const.i 3
  %3 = input 2
  %10:i %11:f %12:f %13:f = loop %1 %3 %3 %3 while (%20:i %21:f %22:f %23:f) {
    %4 = ilt %20 %2
    yield %4
  } do (%30:i %31:f %32:f %33:f) {
    %5 = iadd %30 %2
    %6 = fadd %31 %31
    %7 = fadd %33 %0
    yield %5 %6 %33 %7
  }
  %14:f = loop %3 while (%24:f) {
    %8 = flt %24 %0
    yield %8
  } do (%34:f) {
    %9 = fadd %34 %34
    yield %9
  }
  yield %12
)");
  assign_rates(module);
  EXPECT_EQ(rate_of(module, 10), Rate::constant);
  EXPECT_EQ(rate_of(module, 11), Rate::frame);
  EXPECT_EQ(rate_of(module, 13), Rate::sample);
  EXPECT_EQ(rate_of(module, 12), Rate::sample);  // what another value was, a turn later
  EXPECT_EQ(rate_of(module, 22), Rate::sample);
  EXPECT_EQ(rate_of(module, 34), Rate::frame);   // the same in each turn
  EXPECT_EQ(rate_of(module, 14), Rate::sample);  // but not the turn it ends in
}

Rate array_rate(const std::string& work) {
  auto module = module_of(
      "  array 0 \"a\" 1 4 4 sample\n  %0 = input 0\n  %1 = input 2\n  %2 = const.i 1\n"
      "  %3 = flt %0 %1\n  %4 = flt %1 %1\n  %5 = f2i %0\n" +
      work + "  %90 = array.load 0.0 %5\n  yield %90\n");
  const SplitModule result = split(std::move(module));
  EXPECT_TRUE(ir::verify(result.module).empty());
  EXPECT_EQ(result.module.main().arrays[0].rate,
            result.module.functions[result.frame].arrays[0].rate);
  return result.module.main().arrays[0].rate;
}

TEST(Rates, AnArrayIsOfTheFrameIfAllThatWritesItIsAndItIsReadBehind) {
  EXPECT_EQ(array_rate(""), Rate::frame);
  EXPECT_EQ(array_rate("array.store 0.0 %2 %1\n"), Rate::frame);
  EXPECT_EQ(array_rate("array.store 0.0 %2 %0\n"), Rate::sample);
  EXPECT_EQ(array_rate("array.store 0.0 %5 %1\n"), Rate::sample);
  EXPECT_EQ(array_rate("array.resize 0 %5\n"), Rate::sample);
  EXPECT_EQ(array_rate("if %3 {\n array.store 0.0 %2 %1\n yield\n } else {\n yield\n }\n"),
            Rate::sample);
  EXPECT_EQ(array_rate("if %4 {\n array.store 0.0 %2 %1\n yield\n } else {\n yield\n }\n"),
            Rate::frame);
  // Read by the sample before the last write.
  EXPECT_EQ(
      array_rate("%6 = array.load 0.0 %5\n %7 = flt %6 %1\n check 0 %7\n array.store 0.0 %2 %1\n"),
      Rate::sample);
  // Read by the frame before the last write.
  EXPECT_EQ(array_rate("%6 = array.load 0.0 %2\n array.store 0.0 %2 %6\n"), Rate::frame);
  // In a loop with work of both, the sample would read the end's state in every turn.
  EXPECT_EQ(array_rate(R"(  %10:i = loop %2 while (%20:i) {
    %6 = ilt %20 %2
    yield %6
  } do (%30:i) {
    array.store 0.0 %30 %1
    %7 = array.load 0.0 %2
    %8 = flt %7 %0
    check 0 %8
    %9 = iadd %30 %2
    yield %9
  }
)"),
            Rate::sample);
}

TEST(Split, TheFrameComputesWhatIsTheSameForAllSamples) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = const.f 2
  %3 = fsqrt %1
  %4 = fmul %3 %2
  %5 = fmul %4 %0
  %6 = fadd %5 %2
  yield %6
)");
  const SplitModule result = run_pipeline(std::move(module));
  EXPECT_EQ(body_of(result.module.main()),
            "%0 = input 4\n%1 = input 0\n%2 = const.f 2\n%3 = fmul %0 %1\n"
            "%4 = fadd %3 %2\nyield %4\n");
  EXPECT_EQ(body_of(result.module.functions[result.frame]),
            "%0 = input 2\n%1 = const.f 2\n%2 = fsqrt %0\n%3 = fmul %2 %1\nyield %3\n");
  ASSERT_EQ(result.module.inputs.size(), 5u);
  EXPECT_EQ(result.module.inputs[4].name, "$slot.0");
  EXPECT_EQ(result.module.inputs[4].rate, Rate::frame);
  EXPECT_EQ(result.first_slot, 4u);
}

TEST(Split, IntegersAndBooleansTravelAsFloatsWithAllTheirBits) {
  // The integer's bits are those of a signalling NaN.
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = f2i %1
  %3 = const.i 2139095041
  %4 = iadd %2 %3
  %5 = f2i %0
  %6 = ixor %4 %5
  %7 = fsqrt %1
  %8 = flt %1 %7
  %9 = i2f %6
  %10 = select %8 %9 %0
  yield %10
)");
  const ir::Module before = module;
  const SplitModule result = split(std::move(module));
  EXPECT_EQ(count(result.module, Op::f2bits), 1u);
  EXPECT_EQ(result.module.inputs.size() - result.first_slot, 2u);
  const std::vector<float> inputs = {5.0f, 0.0f, 0.5f, 0.0f};
  EXPECT_EQ(test::run_split(result, inputs), test::run_module(before, inputs));
}

TEST(Split, LoopsAndArraysOfTheFrameMoveAsAWhole) {
  auto module = module_of(R"(  array 0 "center" 1 8 0 sample
  %0 = input 0
  %1 = input 3
  %2 = const.i 0
  %3 = const.i 1
  %4 = f2i %1
  %10:i = loop %2 while (%20:i) {
    %5 = ilt %20 %4
    yield %5
  } do (%30:i) {
    %6 = iadd %30 %3
    array.resize 0 %6
    %7 = i2f %6
    array.store 0.0 %30 %7
    yield %6
  }
  %8 = f2i %0
  %9 = array.load 0.0 %8
  yield %9
)");
  const ir::Module before = module;
  const SplitModule result = run_pipeline(std::move(module));
  EXPECT_EQ(count(result.module, Op::loop), 0u);
  EXPECT_EQ(count(result.module, Op::array_store), 0u);
  EXPECT_EQ(result.module.main().arrays[0].rate, Rate::frame);
  EXPECT_EQ(ir::count_instructions(result.module.functions[result.frame].body, Op::loop), 1u);
  const std::vector<float> inputs = {2.0f, 0.0f, 0.0f, 5.0f};
  EXPECT_EQ(test::run_split(result, inputs).outputs, std::vector<ir::Bits>{ir::to_bits(3.0f)});
  EXPECT_EQ(test::run_module(before, inputs).outputs, std::vector<ir::Bits>{ir::to_bits(3.0f)});
}

TEST(Split, AnIfWithWorkOfBothRatesStandsInBoth) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = const.f 0
  %3 = flt %2 %1
  %10:f = if %3 {
    %4 = fsqrt %1
    %5:f = external 0 %4
    %6:f = external 0 %0
    %7 = fmul %5 %6
    yield %7
  } else {
    yield %1
  }
  yield %10
)");
  const SplitModule result = run_pipeline(std::move(module));
  const ir::Function& frame = result.module.functions[result.frame];
  EXPECT_EQ(ir::count_instructions(frame.body, Op::external), 1u);
  EXPECT_EQ(ir::count_instructions(frame.body, Op::if_), 1u);
  EXPECT_EQ(count(result.module, Op::external), 1u);
  EXPECT_EQ(count(result.module, Op::fsqrt), 0u);
}

TEST(Split, CheapWorkOfTheFrameLeavesTheSamplesIfs) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = flt %0 %1
  %10:f = if %2 {
    %3 = fsqrt %1
    %4:f = external 0 %3
    %5:f = external 0 %0
    %6 = fadd %4 %5
    yield %6
  } else {
    yield %0
  }
  yield %10
)");
  const SplitModule result = run_pipeline(std::move(module));
  const ir::Function& frame = result.module.functions[result.frame];
  EXPECT_EQ(ir::count_instructions(frame.body, Op::fsqrt), 1u);
  EXPECT_EQ(ir::count_instructions(frame.body, Op::external), 1u);
  EXPECT_EQ(count(result.module, Op::external), 1u);
}

TEST(Split, ChecksOfTheFrameAreTheFrames) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = flt %1 %1
  check 0 %2
  %3 = flt %0 %1
  check 0 %3
  if %3 {
    check 0 %2
    yield
  } else {
    yield
  }
  yield %0
)");
  const SplitModule result = split(std::move(module));
  EXPECT_EQ(ir::count_instructions(result.module.functions[result.frame].body, Op::check), 1u);
  EXPECT_EQ(count(result.module, Op::check), 2u);
}

TEST(Split, ALoopOfTheFrameWithTheSamplesWorkIsNotSlotted) {
  // The number of turns is the frame's; what is added up is the sample's.
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = const.f 1
  %10:f %11:f = loop %1 %0 while (%20:f %21:f) {
    %3 = flt %2 %20
    yield %3
  } do (%30:f %31:f) {
    %4 = fsub %30 %2
    %5 = fadd %31 %30
    yield %4 %5
  }
  %6 = fadd %10 %11
  yield %6
)");
  const ir::Module before = module;
  const SplitModule result = run_pipeline(std::move(module));
  EXPECT_EQ(count(result.module, Op::loop), 1u);
  const std::vector<float> inputs = {100.0f, 0.0f, 3.5f, 0.0f};
  // 3.5 + 2.5 + 1.5 is added; 0.5 is left.
  EXPECT_EQ(test::run_split(result, inputs).outputs, std::vector<ir::Bits>{ir::to_bits(108.0f)});
}

TEST(Split, OperationsAreCountedByRate) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 2
  %2 = const.f 2
  %3 = fsqrt %2
  %4 = fmul %3 %1
  %5 = fmul %4 %0
  %6 = fadd %5 %0
  yield %6
)");
  assign_rates(module);
  EXPECT_EQ(ir::count_by_rate(module.main()), (ir::RateCounts{1, 1, 2}));
  EXPECT_EQ(ir::count_instructions(module), 7u);
}

}  // namespace
}  // namespace pse::passes
