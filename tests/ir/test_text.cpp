// The text form: what is printed reads back exactly, and mistakes are told with their line.
#include <gtest/gtest.h>

#include "../support/random_ir.h"
#include "ir/text.h"
#include "ir/verifier.h"

namespace pse::ir {
namespace {

TEST(Text, PrintsWhatTheHeaderShows) {
  Module module;
  module.inputs = {{"x", Rate::sample}};
  module.outputs = {{"color.0"}};
  module.functions.push_back({.name = "main"});
  Function& main = module.functions[0];
  Builder b(module, main);
  const Value x = b.emit(Op::input, {}, 0);
  const Value half = b.const_f32(0.5f);
  main.values[half].rate = Rate::constant;
  const Value below = b.emit(Op::flt, {x, half});
  Region yes, no;
  yes.yields = {half};
  no.yields = {x};
  main.body.yields = b.emit_if(below, std::move(yes), std::move(no));
  EXPECT_EQ(print(module), R"(input 0 "x" sample
output 0 "color.0"
entry function 0 "main" {
  %0 = input 0  # x
  %1!c = const.f 0.5
  %2 = flt %0 %1
  %3:f = if %2 {
    yield %1
  } else {
    yield %0
  }
  yield %3
}
)");
}

TEST(Text, RandomModulesAreValidAndReadBackAsThemselves) {
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Module module = test::random_module(seed, {.checks = true});
    const auto complaints = verify(module);
    ASSERT_TRUE(complaints.empty()) << seed << ": " << complaints.front();
    const std::string text = print(module);
    const auto back = parse(text);
    ASSERT_TRUE(back) << seed << ": " << back.error();
    ASSERT_EQ(print(*back), text) << seed;
    ASSERT_TRUE(verify(*back).empty()) << seed;
  }
}

TEST(Text, KeepsNamesPlacesAndEveryFloat) {
  Module module;
  module.float_tables = {{"odd \"name\"\n\\",
                          {0.1f, -0.0f, INFINITY, -INFINITY, to_f32(nan_bits), to_f32(0xffa00001u),
                           1e-45f, 3.4028235e38f}}};
  module.checks = {{{2, 10, 20}, "index out of range"}};
  module.functions.push_back({.name = "main"});
  Builder b(module, module.functions[0]);
  b.set_span({1, 5, 9});
  b.const_f32(0.1f);
  const auto back = parse(print(module, {.spans = true}));
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(back->float_tables[0].name, module.float_tables[0].name);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(to_bits(back->float_tables[0].entries[i]), to_bits(module.float_tables[0].entries[i]))
        << i;
  }
  EXPECT_EQ(back->checks[0].span, (Span{2, 10, 20}));
  EXPECT_EQ(back->functions[0].body.body[0].span, (Span{1, 5, 9}));
}

TEST(Text, TellsTheLineOfAMistake) {
  const auto error_of = [](std::string_view text) {
    const auto module = parse(text);
    return module ? std::string("no error") : module.error();
  };
  EXPECT_EQ(error_of("entry function 0 \"main\" {\n  %0 = fade\n  yield\n}"),
            "line 2: an operator was expected, not 'fade'");
  EXPECT_EQ(error_of("function 0 \"f\" (%0) {"), "line 1: a parameter has a type, not ')'");
  EXPECT_EQ(error_of("function 0 \"f\" {\n %0 = const.f 1"),
            "line 2: an operator was expected, not ''");
  EXPECT_EQ(error_of("input 0 \"x"), "line 1: a quoted name does not end");
  EXPECT_EQ(error_of("input 0 \"x\" often"), "line 1: a rate was expected, not 'often'");
  EXPECT_EQ(error_of("function 0 \"f\" {\n %99999999 = const.f 1\n yield }"),
            "line 2: a value was expected, not '='");
}

TEST(Text, NestingIsBounded) {
  std::string text = "function 0 \"f\" {\n %0 = const.b true\n";
  for (int i = 0; i < 1000; ++i) text += "if %0 {\n";
  EXPECT_FALSE(parse(text));
}

}  // namespace
}  // namespace pse::ir
