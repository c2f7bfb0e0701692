// Every kind of broken module is rejected, with the sentence that names its fault.
#include <gtest/gtest.h>

#include <algorithm>

#include "ir/text.h"
#include "ir/verifier.h"

namespace pse::ir {
namespace {

constexpr std::string_view sound = R"(
table.f 0 "floats" 1 2 3 4
table.i 0 "ints" 1 2
input 0 "x" sample
output 0 "out"
check 0 "must hold"
external 0 "lookup" 2 1
function 0 "twice" (%0:f) {
  %1 = fadd %0 %0
  yield %1
}
entry function 1 "main" {
  array 0 "a" 2 4 0 sample
  %0 = input 0
  %1:f = call 0 %0
  %2 = const.i 1
  %3 = const.b true
  %4:f = external 0 %0 %1
  %5 = table.f 0 %2
  array.store 0.1 %2 %5
  check 0 %3
  %6:i = loop %2 while (%7:i) {
    %8 = ilt %7 %2
    yield %8
  } do (%9:i) {
    %10 = iadd %9 %2
    yield %10
  }
  %11:f = if %3 {
    yield %4
  } else {
    %12 = fneg %4
    yield %12
  }
  yield %11
}
)";

// The sound module with one part of its text replaced.
std::vector<std::string> complaints_with(std::string_view part, std::string_view by) {
  std::string text(sound);
  const auto at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  text.replace(at, part.size(), by);
  const auto module = parse(text);
  EXPECT_TRUE(module) << module.error();
  return module ? verify(*module) : std::vector<std::string>{};
}

TEST(Verifier, HasNothingAgainstASoundModule) {
  const auto module = parse(sound);
  ASSERT_TRUE(module) << module.error();
  EXPECT_EQ(verify(*module), std::vector<std::string>{});
}

struct Fault {
  std::string_view part, by, complaint;
};

TEST(Verifier, NamesEachFault) {
  const Fault faults[] = {
      {"%10 = iadd %9 %2", "%10 = iadd %9 %0", "main: %10 = iadd: operand 2 has the wrong type"},
      {"%10 = iadd %9 %2", "%10 = iadd %9", "main: %10 = iadd: wrong number of operands"},
      {"%12 = fneg %4", "%12:i = fneg %4", "main: %12 = fneg: the result has the wrong type"},
      {"%12 = fneg %4", "%12 = fneg %99", "main: fneg uses %99, which is not visible there"},
      {"%12 = fneg %4", "%12 = fneg %10", "main: fneg uses %10, which is not visible there"},
      {"%10 = iadd %9 %2", "%10 = iadd %7 %2", "main: iadd uses %7, which is not visible there"},
      {"%1:f = call 0 %0", "%1:f = call 0 %11", "main: call uses %11, which is not visible there"},
      {"%12 = fneg %4", "%4 = fneg %0\n %12 = fneg %4", "main: %4 is defined twice"},
      {"  yield %11\n", "  yield %12\n", "main: a yield uses %12, which is not visible there"},
      {"  yield %11\n", "  yield\n", "the entry function yields one value per output"},
      {"  yield %11\n", "  yield %2\n", "outputs are floats"},
      {"yield %4", "yield", "main: %11 = if: wrong number of yields"},
      {"yield %4", "yield %2", "main: %11 = if: yields have the wrong types"},
      {"= if %3", "= if %2", "main: %11 = if: operand 1 has the wrong type"},
      {"yield %8", "yield %7", "main: %6 = loop: its head yields one boolean"},
      {"yield %8", "yield", "main: %6 = loop: its head yields one boolean"},
      {"do (%9:i)", "do (%9:i %20:i)", "main: %6 = loop: wrong number of parameters of the body"},
      {"while (%7:i)", "while (%7:i %20:i)",
       "main: %6 = loop: wrong number of parameters of the head"},
      {"yield %10", "yield %0", "main: %6 = loop: yields of the body have the wrong types"},
      {"%6:i = loop", "%6:f = loop", "main: %6 = loop: results have the wrong types"},
      {"%0 = input 0", "%0 = input 1", "main: %0 = input: there is no such input"},
      {"%0 = input 0", "%0 = input -1", "main: %0 = input: there is no such input"},
      {"table.f 0 %2", "table.f 1 %2", "main: %5 = table.f: there is no such float table"},
      {"check 0 %3", "check 1 %3", "main: check: there is no such check"},
      {"external 0 %0 %1", "external 1 %0 %1", "main: %4 = external: there is no such external"},
      {"external 0 %0 %1", "external 0 %0", "main: %4 = external: wrong number of operands"},
      {"external 0 %0 %1", "external 0 %0 %2", "main: %4 = external: an external takes floats"},
      {"%4:f = external", "%4:f %21:f = external", "main: %4 = external: wrong number of results"},
      {"array.store 0.1", "array.store 1.0", "main: array.store: there is no such array"},
      {"array.store 0.1", "array.store 0.2", "main: array.store: the array has no such component"},
      {"\"a\" 2 4 0", "\"a\" 2 4 5",
       "main: the initial length of array 'a' is not within its capacity"},
      {"\"a\" 2 4 0", "\"a\" 0 4 0", "main: array 'a' has no size"},
      {"call 0 %0", "call 7 %0", "main: %1 = call: there is no such function"},
      {"call 0 %0", "call 0 %0 %0", "main: %1 = call: wrong number of operands"},
      {"call 0 %0", "call 1", "the entry function is never called"},
      {"%1 = fadd %0 %0", "%1 = input 0", "twice: %1 = input: a called function has no inputs"},
      {"%1 = fadd %0 %0", "%1:f = call 0 %0", "function 'twice' calls itself"},
      {"(%0:f) {", "(%0:f) {\n array 0 \"b\" 1 1 0 sample",
       "twice: a called function has no arrays"},
      {"\"floats\" 1 2 3 4", "\"floats\" 1 2 3",
       "the size of table 'floats' must be a power of two"},
      {"\"ints\" 1 2", "\"ints\"", "the size of table 'ints' must be a power of two"},
      {"table.i 0", "table.b 0 \"bytes\" 1 2\ntable.i 0",
       "byte table 'bytes' must have 256 entries"},
      {"\"main\" {", "\"main\" (%30:f) {", "the entry function has no parameters"},
  };
  for (const Fault& fault : faults) {
    const auto complaints = complaints_with(fault.part, fault.by);
    EXPECT_TRUE(std::ranges::find(complaints, fault.complaint) != complaints.end())
        << fault.by << "\ngives: " << (complaints.empty() ? "nothing" : complaints.front());
  }
}

TEST(Verifier, FunctionsThatCallEachOtherAreFound) {
  const auto module = parse(R"(function 0 "a" { call 1
 yield }
function 1 "b" { call 0
 yield }
entry function 2 "main" { call 0
 yield }
)");
  ASSERT_TRUE(module) << module.error();
  const auto complaints = verify(*module);
  ASSERT_EQ(complaints.size(), 1u);
  EXPECT_EQ(complaints[0], "function 'a' calls itself");
}

TEST(Verifier, SurvivesModulesWithoutSense) {
  Module module;
  EXPECT_FALSE(verify(module).empty());
  module.functions.push_back({.name = "main"});
  Instruction in{.op = Op::loop, .operands = {5, no_value}, .results = {no_value, 3}};
  module.functions[0].body.body.push_back(in);
  in.op = Op::if_;
  module.functions[0].body.body.push_back(in);
  in.regions.resize(2);
  in.regions[0].yields = {77};
  module.functions[0].body.body.push_back(in);
  in.op = Op::loop;
  module.functions[0].body.body.push_back(in);
  in.op = Op::call;
  in.imm = -3;
  module.functions[0].body.body.push_back(in);
  EXPECT_FALSE(verify(module).empty());
}

}  // namespace
}  // namespace pse::ir
