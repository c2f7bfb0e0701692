// Which rewrites the folder makes, and which it must not make.
#include <algorithm>

#include "pass_test.h"

namespace pse::passes {
namespace {

using ir::Op;
using test::count;
using test::module_of;

// What becomes of one instruction %9 that computes from %0 (x), %1 (y), %2 .. %8 as below: the text
// of what is yielded.
std::string folded(const std::string& instruction) {
  const std::string before = R"(  %0 = input 0
  %1 = input 1
  %2 = f2i %0
  %3 = flt %0 %1
  %4 = const.f 1
  %5 = const.i 0
  %6 = fneg %0
  %7 = fneg %1
  %8 = bnot %3
)";
  // Integers and booleans reach the output through one more instruction.
  const bool is_float = instruction.starts_with("f:");
  const bool is_integer = instruction.starts_with("i:");
  const std::string wrap =
      is_float ? "  yield %19\n"
      : is_integer
          ? "  %20 = i2f %19\n  yield %20\n"
          : "  %20 = fle %1 %0\n  %21 = band %19 %20\n  %22 = select %21 %4 %0\n  yield %22\n";
  ir::Module module = module_of(before + instruction.substr(2) + "\n" + wrap);
  fold(module);
  remove_dead(module);
  // The definition of what the last instructions use.
  EXPECT_TRUE(ir::verify(module).empty());
  const ir::Region& body = module.main().body;
  ir::Value wanted = body.yields[0];
  // Back from the output to what was folded.
  const auto definition = [&](ir::Value value) -> const ir::Instruction& {
    return *std::ranges::find_if(body.body,
                                 [&](const ir::Instruction& in) { return in.results[0] == value; });
  };
  if (!is_float) wanted = definition(wanted).operands[0];
  if (!is_float && !is_integer) wanted = definition(wanted).operands[0];
  for (const ir::Instruction& in : body.body) {
    if (in.results.empty() || in.result() != wanted) continue;
    std::string shown(ir::info(in.op).name);
    if (in.op == Op::const_f32) shown += " " + std::to_string(in.imm_f32());
    if (in.op == Op::const_i32 || in.op == Op::input) shown += " " + std::to_string(in.imm);
    for (const ir::Value operand : in.operands) shown += " %" + std::to_string(operand);
    return shown;
  }
  return "nothing";
}

TEST(Fold, RewritesWhatIsExact) {
  EXPECT_EQ(folded("f:%19 = fmul %0 %4"), "input 0");
  EXPECT_EQ(folded("f:%19 = fmul %4 %0"), "input 0");
  EXPECT_EQ(folded("f:%18 = const.f -1\n%19 = fmul %0 %18"), "fneg %0");
  EXPECT_EQ(folded("f:%18 = const.f -0\n%19 = fadd %0 %18"), "input 0");
  EXPECT_EQ(folded("f:%18 = const.f 0\n%19 = fsub %0 %18"), "input 0");
  EXPECT_EQ(folded("f:%18 = const.f -0\n%19 = fsub %18 %0"), "fneg %0");
  EXPECT_EQ(folded("f:%19 = fadd %0 %7"), "fsub %0 %1");
  EXPECT_EQ(folded("f:%19 = fadd %6 %1"), "fsub %1 %0");
  EXPECT_EQ(folded("f:%19 = fsub %0 %7"), "fadd %0 %1");
  EXPECT_EQ(folded("f:%19 = fmul %6 %7"), "fmul %0 %1");
  EXPECT_EQ(folded("f:%19 = fneg %6"), "input 0");
  EXPECT_EQ(folded("f:%19 = fabs %6"), "fabs %0");
  EXPECT_EQ(folded("f:%18 = fabs %0\n%19 = fabs %18"), "fabs %0");
  EXPECT_EQ(folded("f:%19 = fdiv %0 %4"), "input 0");
  EXPECT_EQ(folded("f:%18 = const.f 8\n%19 = fdiv %0 %18").substr(0, 7), "fmul %0");
  EXPECT_EQ(folded("f:%18 = const.f 0\n%17 = fabs %0\n%19 = fadd %17 %18"), "fabs %0");
  EXPECT_EQ(folded("f:%18 = const.f -0\n%19 = fma %0 %1 %18"), "fmul %0 %1");
  EXPECT_EQ(folded("f:%19 = fma %0 %4 %1"), "fadd %0 %1");
  EXPECT_EQ(folded("f:%19 = fmin %0 %0"), "input 0");
  EXPECT_EQ(folded("f:%18 = ffloor %0\n%19 = fround %18"), "ffloor %0");
  EXPECT_EQ(folded("f:%18 = i2f %2\n%19 = ffloor %18"), "i2f %2");
  EXPECT_EQ(folded("f:%18 = f2bits %0\n%19 = bits2f %18"), "input 0");
  EXPECT_EQ(folded("f:%18 = const.f 2\n%17 = const.f 3\n%19 = fadd %18 %17"), "const.f 5.000000");
  EXPECT_EQ(folded("f:%18 = const.i 6\n%19 = table.f 0 %18"), "const.f 3.000000");
  EXPECT_EQ(folded("f:%18 = const.b true\n%19 = select %18 %1 %0"), "input 1");
  EXPECT_EQ(folded("f:%19 = select %8 %0 %1"), "select %3 %1 %0");
  EXPECT_EQ(folded("i:%19 = iadd %2 %5"), "f2i %0");
  EXPECT_EQ(folded("i:%18 = ftrunc %0\n%19 = f2i %18"), "f2i %0");
  EXPECT_EQ(folded("b:%19 = bnot %8"), "flt %0 %1");
  EXPECT_EQ(folded("b:%18 = feq %0 %1\n%19 = bnot %18"), "fne %0 %1");
  EXPECT_EQ(folded("b:%18 = ilt %2 %5\n%19 = bnot %18").substr(0, 3), "ile");
  EXPECT_EQ(folded("b:%19 = fle %0 %0"), "feq %0 %0");
  EXPECT_EQ(folded("b:%18 = const.b true\n%17 = const.b false\n%19 = select %3 %18 %17"),
            "flt %0 %1");
  EXPECT_EQ(folded("b:%18 = const.b true\n%19 = bxor %3 %18"), "bnot %3");
}

TEST(Fold, LeavesWhatIsNotExact) {
  // -0 + 0 is 0; inf * 0 is NaN; inf - inf is NaN; NaN is not equal to itself; 1/3 is rounded.
  EXPECT_EQ(folded("f:%18 = const.f 0\n%19 = fadd %0 %18").substr(0, 4), "fadd");
  EXPECT_EQ(folded("f:%18 = const.f -0\n%19 = fsub %0 %18").substr(0, 4), "fsub");
  EXPECT_EQ(folded("f:%18 = const.f 0\n%19 = fsub %18 %0").substr(0, 4), "fsub");
  EXPECT_EQ(folded("f:%18 = const.f 0\n%19 = fmul %0 %18").substr(0, 4), "fmul");
  EXPECT_EQ(folded("f:%19 = fsub %0 %0"), "fsub %0 %0");
  EXPECT_EQ(folded("f:%19 = fdiv %0 %0"), "fdiv %0 %0");
  EXPECT_EQ(folded("f:%18 = const.f 3\n%19 = fdiv %0 %18").substr(0, 4), "fdiv");
  EXPECT_EQ(folded("f:%18 = const.f 0\n%19 = fma %0 %1 %18").substr(0, 3), "fma");
  EXPECT_EQ(folded("f:%18 = fsub %0 %1\n%19 = fneg %18").substr(0, 4), "fneg");
  EXPECT_EQ(folded("b:%19 = feq %0 %0"), "feq %0 %0");
  EXPECT_EQ(folded("b:%19 = fne %0 %0"), "fne %0 %0");
  EXPECT_EQ(folded("b:%19 = bnot %3"), "bnot %3");  // not fle: both are false for NaN
  // 2^-127 as a divisor: its reciprocal is no normal number's.
  EXPECT_EQ(folded("f:%18 = const.f 5.877472e-39\n%19 = fdiv %0 %18").substr(0, 4), "fdiv");
}

TEST(Fold, GathersTheConstantsOfIntegers) {
  auto module = module_of(R"(  %0 = input 0
  %1 = f2i %0
  %2 = const.i 3
  %3 = iadd %1 %2
  %4 = iadd %2 %3
  %5 = isub %4 %2
  %6 = i2f %5
  yield %6
)");
  fold(module);
  remove_dead(module);
  EXPECT_EQ(count(module, Op::iadd), 1u);
  EXPECT_EQ(count(module, Op::isub), 0u);
}

TEST(Fold, AKnownConditionLeavesOneSide) {
  auto module = module_of(R"(  %0 = input 0
  %1 = const.b false
  %5:f = if %1 {
    %2 = fsqrt %0
    yield %2
  } else {
    %3 = ffloor %0
    yield %3
  }
  check 0 %1
  %6 = bnot %1
  check 0 %6
  yield %5
)");
  fold(module);
  EXPECT_EQ(count(module, Op::if_), 0u);
  EXPECT_EQ(count(module, Op::fsqrt), 0u);
  EXPECT_EQ(count(module, Op::ffloor), 1u);
  EXPECT_EQ(count(module, Op::check), 1u);  // that of false stays, that of true goes
}

TEST(Fold, ASideKnowsItsCondition) {
  auto module = module_of(R"(  %0 = input 0
  %1 = input 1
  %2 = flt %0 %1
  %3 = feq %0 %1
  %4 = band %2 %3
  %10:f = if %4 {
    %5 = select %3 %0 %1
    yield %5
  } else {
    %6 = fsqrt %0
    %7 = select %4 %0 %6
    yield %7
  }
  yield %10
)");
  fold(module);
  EXPECT_EQ(count(module, Op::select), 0u);
}

TEST(Fold, RunsCallsOfConstants) {
  auto module = module_of(R"(  %0 = const.f 3
  %1:f = call 0 %0
  yield %1
)",
                          R"(function 0 "cube" (%0:f) {
  %1 = fmul %0 %0
  %2 = fmul %1 %0
  yield %2
}
)");
  fold(module);
  EXPECT_EQ(count(module, Op::call), 0u);
  const ir::Instruction& last = module.main().body.body.back();
  EXPECT_EQ(last.op, Op::const_f32);
  EXPECT_EQ(last.imm_f32(), 27.0f);
}

TEST(Fold, LeavesCallsThatDoNotEndOrAskTheHost) {
  auto module = module_of(R"(  %0 = const.f 3
  %1:f = call 0 %0
  %2:f = call 1 %0
  %3 = fadd %1 %2
  yield %3
)",
                          R"(function 0 "forever" (%0:f) {
  %1 = const.b true
  loop while {
    yield %1
  } do {
    yield
  }
  yield %0
}
function 1 "asks" (%0:f) {
  %1:f = external 0 %0
  yield %1
}
)");
  fold(module);
  EXPECT_EQ(count(module, Op::call), 2u);
}

}  // namespace
}  // namespace pse::passes
