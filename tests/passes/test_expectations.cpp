// Expectations on their way through the passes: calls that hand values on, then effects.
#include "ir/expectations.h"
#include "pass_test.h"

namespace pse::passes {
namespace {

using ir::Op;
using test::count;

// A module with body and the external "expect 1" in both forms.
ir::Module expecting(const std::string& body) {
  const std::string text = R"(input 0 "x" sample
input 1 "time" frame
output 0 "out"
check 0 "must hold"
check 1 "`f` is \"odd\"\x0ado not"
external 0 "lookup" 1 1
external 1 "expect 1" 3 2
external 2 "expect 1" 2 0
entry function 0 "main" {
)" + body + "}\n";
  auto module = ir::parse(text);
  EXPECT_TRUE(module) << module.error();
  if (!module) return {};
  const auto complaints = ir::verify(*module);
  EXPECT_TRUE(complaints.empty()) << complaints.front();
  EXPECT_EQ(ir::print(*ir::parse(ir::print(*module))), ir::print(*module));
  return std::move(*module);
}

constexpr const char* handed_on = R"(  %0 = input 0
  %1 = fneg %0
  %2:f %3:f = external 1 %1 %0 %1
  %4:f = external 0 %3
  %5 = fadd %2 %4
  yield %5
)";
// Told of a pixel in a loop in which nothing else is of use.
constexpr const char* told = R"(  %0 = input 0
  %1 = const.f 0
  %2:f = loop %1 while (%3:f) {
    %4 = flt %3 %0
    yield %4
  } do (%5:f) {
    %6 = const.f 1
    %7 = fadd %5 %6
    %8 = fsqrt %7
    %9 = flt %8 %0
    if %9 {
      yield
    } else {
      external 2 %0 %0
      yield
    }
    yield %7
  }
  yield %0
)";

TEST(Expectations, AreKnownByTheirNames) {
  EXPECT_EQ(ir::expectation_of({ir::expectation_name(7), 2, 0}), 7);
  for (const char* name : {"expect", "expect ", "expect -1", "expect 7a", "expect 99999999999",
                           "texture expect 7", "volume 1", ""})
    EXPECT_FALSE(ir::expectation_of({name, 2, 0})) << name;
  // A condition and values, or a pixel.
  EXPECT_EQ(ir::expectation_of({"expect 3", 4, 3}), 3);
  for (const auto& [arguments, results] : {std::pair(1, 1), {2, 2}, {5, 3}, {3, 0}, {0, 0}})
    EXPECT_FALSE(ir::expectation_of({"expect 3", arguments, results}));
}

TEST(Expectations, SettleWhereTheirValuesAreWanted) {
  ir::Module module = expecting(handed_on);
  settle_expectations(module);
  EXPECT_TRUE(ir::verify(module).empty()) << ir::verify(module).front();
  // The pixel's place comes from the stream, and the call gives nothing.
  ASSERT_EQ(module.inputs.size(), 4u);
  EXPECT_EQ(module.inputs[2].name, "px");
  EXPECT_EQ(module.inputs[3].name, "py");
  ASSERT_EQ(module.externals.size(), 2u);
  EXPECT_EQ(module.externals[1].name, "expect 1");
  EXPECT_EQ(module.externals[1].results, 0);
  EXPECT_EQ(count(module, Op::if_), 1u);
  EXPECT_EQ(count(module, Op::external), 2u);
  // The values are those that were handed on: -x + lookup(-x) of %0 and %1.
  const ir::Instruction& sum = module.main().body.body.back();
  EXPECT_EQ(sum.operands[0], module.main().body.body[0].result());
  remove_dead(module);
  EXPECT_EQ(count(module, Op::external), 2u);

  ir::Module unwanted = expecting(handed_on);
  unwanted.main().body.yields = {unwanted.main().body.body[0].result()};
  remove_dead(unwanted);
  settle_expectations(unwanted);
  EXPECT_EQ(count(unwanted, Op::external), 0u);
  EXPECT_EQ(count(unwanted, Op::if_), 0u);
}

TEST(Expectations, AreDroppedWithAllThatServedThem) {
  for (const char* body : {handed_on, told}) {
    ir::Module module = expecting(body);
    ir::drop_expectations(module);
    EXPECT_FALSE(ir::has_expectations(module));
    EXPECT_EQ(module.externals.size(), 1u);
    EXPECT_TRUE(ir::verify(module).empty());
    remove_dead(module);
    EXPECT_EQ(count(module, Op::loop), 0u);
    EXPECT_EQ(count(module, Op::fsqrt), 0u);
  }
  // Those that are told already stay until they are dropped.
  ir::Module module = expecting(told);
  ir::release_expected_values(module);
  EXPECT_EQ(count(module, Op::external), 1u);
}

TEST(Expectations, ThatAreToldOutliveAllPasses) {
  ir::Module module = expecting(told);
  remove_dead(module);
  EXPECT_EQ(count(module, Op::external), 1u);
  EXPECT_EQ(count(module, Op::fsqrt), 1u);
  const SplitModule split = run_pipeline(std::move(module), {});
  EXPECT_EQ(count(split.module, Op::external), 1u);
  EXPECT_EQ(count(split.module, Op::loop), 1u);
  EXPECT_EQ(ir::count_instructions(split.module.functions[split.frame].body, Op::external), 0u);
}

// A condition of the frame's: the frame decides, the samples tell.
TEST(Expectations, OfAFrameAreToldBySamples) {
  ir::Module module = expecting(R"(  %0 = input 0
  %1 = input 1
  %2 = const.f 3
  %3 = flt %1 %2
  if %3 {
    yield
  } else {
    external 2 %0 %0
    yield
  }
  yield %1
)");
  const SplitModule split = run_pipeline(std::move(module), {});
  EXPECT_EQ(count(split.module, Op::external), 1u);
  EXPECT_EQ(ir::count_instructions(split.module.functions[split.frame].body, Op::external), 0u);
}

// Known to hold, or known to fail.
TEST(Expectations, FoldWithTheirConditions) {
  for (const int holds : {0, 1}) {
    ir::Module module = expecting("  %0 = input 0\n  %1 = const.f " + std::to_string(holds) +
                                  "\n  %2:f %3:f = external 1 %1 %0 %0\n  yield %2\n");
    settle_expectations(module);
    const SplitModule split = run_pipeline(std::move(module), {});
    EXPECT_EQ(count(split.module, Op::external), holds == 1 ? 0u : 1u);
    EXPECT_EQ(count(split.module, Op::if_), 0u);
  }
}

}  // namespace
}  // namespace pse::passes
