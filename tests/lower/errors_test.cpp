// What is refused: the code, the line and the advice of each error.
#include <gtest/gtest.h>

#include "support/run_program.h"

namespace pse::test {
namespace {

struct Case {
  const char* text;
  const char* expected;  // must occur in messages()
};

class Refused : public testing::TestWithParam<Case> {};

TEST_P(Refused, SaysWhatAndWhere) {
  const Outcome outcome =
      run_program(GetParam().text, {.stream = {{"point", {1, 2, 3}}, {"fg.color", {1, 1, 1}}},
                                    .frame = {{"frame", {1}}},
                                    .knobs = {}});
  EXPECT_FALSE(outcome.compiled) << GetParam().text;
  EXPECT_NE(outcome.messages().find(GetParam().expected), std::string::npos)
      << GetParam().text << "\nexpected: " << GetParam().expected
      << "\ngot: " << outcome.messages();
}

INSTANTIATE_TEST_SUITE_P(
    All, Refused,
    testing::Values(
        Case{"a = 1\nb = poimt",
             "2:unknown-name: `poimt` is not set here, and the stream does not bring it (did you "
             "mean `point`?)"},
        Case{"a = fg.colour",
             "1:unknown-channel: image `fg` has no channel `colour` (did you mean `color`?)"},
        Case{"a = squirt(4)", "1:unknown-function: there is no function `squirt`"},
        Case{"a = [1 2] + [1 2 3]",
             "1:operand-types: `+` does not work on a vector of 2 and a vector of 3"},
        Case{"a = \"x\" * 2", "1:operand-types: `*` does not work on a text and a number"},
        Case{"if [1 2]\n  a = 1",
             "1:not-a-condition: a condition is a truth value or a number, this is a vector of 2"},
        Case{"function rock(p)\n  return p\na = density_normal(rock, [0 0 1])",
             "1:density: `rock` is used as a density and has to return one number, it returns a "
             "vector of 3"},
        Case{"function rock(p)\n  q = p\na = density_normal(rock, [0 0 1])",
             "1:density: `rock` is used as a density and has to return one number, it returns "
             "nothing"},
        Case{"function f(x)\n  return f(x)\na = f(1)", "2:recursion: `f` calls itself"},
        Case{"function f(x)\n  return g(x)\nfunction g(x)\n  return f(x)\na = f(1)",
             "4:recursion: `f` calls itself through `g`"},
        Case{"function f(x)\n  return x\na = f()", "3:argument-count: `f` needs a value for `x`"},
        Case{"function f(x)\n  return x\na = f(1, 2)",
             "3:argument-count: `f` takes 1 argument, this is one more"},
        Case{"function f(x)\n  return x\na = f(y = 2)",
             "3:unknown-argument: `f` has no parameter `y`"},
        Case{"p = [1 2]\na = p[3]", "2:index-range: this index of `p` is outside 1..2"},
        Case{"p = [1 2]\np[0] = 1", "2:index-range: index 0 is outside 1..2 of `p`"},
        Case{"a = point.w", "1:unknown-component: a vector of 3 has no component `w`"},
        Case{"function f(x, x)\n  return x\na = f(1, 2)",
             "1:parameter-twice: `f` has two parameters named `x`"},
        Case{"function f(x)\n  return x\nfunction f(y)\n  return y\na = f(1)",
             "3:function-twice: function `f` is defined twice"},
        Case{"a = 1\nb = turbulence_octaves(\"fast\")",
             "2:operand-types: `turbulence_octaves` cannot be called with a text: `*` does not "
             "work on a text and a "
             "number (see library/turbulence.pse:"},
        Case{"a = spline(0.5, [1])",
             "1:index-base: `spline` cannot be called with a number and a number: "},
        Case{"function f(p)\n  q = p\na = sqrt(f(1))", "3:no-value: `f` returns no value"},
        Case{"a = Noise(point, sed = 2)",
             "1:unknown-argument: `Noise` has no parameter `sed` (did you mean `seed`?)"},
        Case{"a = vec3(1, 2, 3)",
             "1:unknown-function: there is no function `vec3` (write a vector as `[a b c]`)"},
        Case{"color = sin",
             "1:output-kind: `color` is a function, which makes no picture (call the function)"},
        Case{"color = \"red\"", "1:output-kind: `color` is a text, which makes no picture"},
        Case{"color = [1 2 3 4 5]", "1:output-kind: `color` is a vector of 5"},
        Case{"a = q\nq = 1",
             "1:unknown-name: `q` is not set here, and the stream does not bring it (it is set "
             "further down"},
        Case{"a = color", "(an image brings `fg.color`)"},
        Case{"import wave", "1:unknown-module: there is no module `wave` (did you mean `waves`?)"},
        Case{"a = point.xw", "1:unknown-component: a vector of 3 has no component `w`"},
        Case{"function offer(f)\n  return f(1, 2)\nfunction one(p)\n  return p\na = offer(one)",
             "2:argument-count: `one` takes 1 argument, this is one more"},
        Case{"return 3", "1:return-outside: `return` outside a function"},
        Case{"break", "1:not-in-loop: `break` outside a loop"},
        Case{"import nothing_here", "1:unknown-module: there is no module `nothing_here`"},
        Case{"a = 1\nfor i in 3\n  a = i",
             "2:not-a-sequence: `for` runs over a range, an array or a vector; this is a number"},
        Case{"if point.x > 0\n  a = [1 2]\nelse\n  a = [1 2 3]",
             "1:branch-types: `a` is a vector of 2 in one branch and a vector of 3 in the other"},
        Case{"function f(x)\n  y = x\na = f(1)", "3:no-value: this gives `a` no value"},
        Case{"a = b\nb = 1",
             "1:unknown-name: `b` is not set here, and the stream does not bring it"},
        Case{"a = [[1 2] [3 4]] * [1 2 3]",
             "1:shapes: cannot multiply a 2x2 matrix with a vector of 3"}));

TEST(Errors, AreAllReportedAtOnce) {
  const Outcome outcome = run_program("a = one\nb = two\nc = three()\n");
  EXPECT_EQ(outcome.diagnostics.error_count(), 3u) << outcome.messages();
}

TEST(Errors, OneMistakeIsReportedOnce) {
  const Outcome outcome =
      run_program("a = missing\nb = a + 1\nc = b.x\nfor i in [1 .. 3]\n  c += a\n");
  EXPECT_EQ(outcome.diagnostics.error_count(), 1u) << outcome.messages();
}

// How many errors a text has, whatever they are.
std::size_t errors_of(const char* text) { return run_program(text).diagnostics.error_count(); }

TEST(Errors, NoneFollowsFromAnother) {
  EXPECT_EQ(errors_of("a = smoothstep(\"a\", 1, 2)"), 1u);
  EXPECT_EQ(errors_of("a = spline(0.5, 1)"), 1u);
  EXPECT_EQ(errors_of("function f(a, a)\n  return a\nb = f(1, 2)"), 1u);
  EXPECT_EQ(errors_of("function f(a)\n  return a\nfunction f(b)\n  return b\nc = f(1)"), 1u);
  EXPECT_EQ(errors_of("function f(x)\n  function g(y)\n    return y\n  return x\na = f(1)"), 1u);
  EXPECT_EQ(errors_of("radius = 1 [[ min = 0 ]]"), 1u);
  EXPECT_EQ(errors_of("for i in 1 .. 10\n  a = i"), 1u);
  EXPECT_EQ(errors_of("def f(x):\n  return x\na = f(1)"), 1u);
  EXPECT_EQ(errors_of("float t = 3\na = t"), 1u);
  EXPECT_EQ(errors_of("if 1 > 0\n  a = 1\n else\n  a = 2"), 1u);
  EXPECT_EQ(errors_of("a[1] = missing\nb = a[1] + count(a)"), 1u);
  EXPECT_EQ(errors_of("a[missing] = 1\nb = a[1]"), 1u);
}

TEST(Errors, EachWrongCallOfTheLibraryIsOne) {
  const Outcome outcome =
      run_program("a = fbm(\"a\")\nb = fbm(\"b\")\nfor i in [1 .. 3]\n  c = i + spline(i, 1)");
  EXPECT_EQ(outcome.diagnostics.error_count(), 3u) << outcome.messages();
}

TEST(Warnings, WhatVariesIsQuestionedInFrameBlocks) {
  const auto warned = [](const char* text) {
    return run_program(text, {.stream = {{"u", {1}}}, .frame = {{"time", {1}}}, .knobs = {}})
               .messages()
               .find("2:varies-in-frame: `u`") != std::string::npos;
  };
  EXPECT_TRUE(warned("if begin_frame\n  a = u * 2\nb = a"));
  EXPECT_FALSE(warned("if begin_frame\n  a = time * 2\nb = a * u"));
}

// One mistake makes one error, and each of them says where.
TEST(Refused, OneMistakeIsOneError) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {"a = filterwidth(", "1:unclosed-bracket"},
      {"a = sin(", "1:unclosed-bracket"},
      {"a = Dx(", "1:unclosed-bracket"},
      {"a = texture(\"foo", "1:open-string"},
      {"import sums of", "1:unexpected-word"},
      {"function f(a)\nb = f(1)", "1:missing-block"},
      {"a = foo + foo\nb = 2 * foo", "1:unknown-name"},
      {"a = array(-1)", "`array` needs a constant from 1 to 1048576, this is -1"},
      {"a = 2 > 1 ? \"x\" : 3", "the value of `? :` is a text in one branch and a number in the"},
      {"a = [[1 2][3 4]]", "put a blank before a `[` that begins a new row"},
      {"a = 2 frame", "write `*` to multiply"},
      {"while = 3", "choose another name: `while` is a word of the language"}};
  for (const auto& [text, expected] : table) {
    const Outcome outcome = run_program(text, {.frame = {{"frame", {1}}}});
    EXPECT_EQ(outcome.diagnostics.error_count(), 1u) << text << "\n" << outcome.messages();
    EXPECT_NE(outcome.messages().find(expected), std::string::npos) << text << "\n"
                                                                    << outcome.messages();
  }
  // Other lines' mistakes are told all the same, and so is each place of a name that is like
  // another.
  EXPECT_EQ(run_program("a = sin(\nb = cos()\nc = [1 2] + [1 2 3]").diagnostics.error_count(), 3u);
  EXPECT_EQ(run_program("radius = 1\na = radus\nb = radus").diagnostics.error_count(), 2u);
}

// An array that errors kept empty is not blamed for it, one that nobody fills is.
TEST(Errors, OfWhatGoesIntoAnArrayAreNoneOfTheArray) {
  const std::string loop = "a = array(4)\nfor i in [1 .. 3]\n  if i > 1\n    a[i] = ";
  EXPECT_EQ(run_program(loop + "nothing_here\nb = a[1]").diagnostics.error_count(), 1u);
  const Outcome unfilled = run_program("a = array(4)\nb = a[1]");
  EXPECT_NE(unfilled.messages().find("empty-array"), std::string::npos) << unfilled.messages();
}

TEST(Warnings, ALoneComparisonIsQuestionedOnce) {
  EXPECT_EQ(run_program("a = 1\na == 3").diagnostics.all().size(), 1u);
}

TEST(Warnings, HidingAConstantIsQuestioned) {
  EXPECT_NE(run_program("PI = 3\na = PI").messages().find("hides-constant"), std::string::npos);
  EXPECT_EQ(run_program("Radius = 3\na = Radius").messages(), "");
}

TEST(Limits, ProgramsThatGrowWithoutBoundAreRefused) {
  // Forty functions, each calling the one before twice: a million million operations if they were
  // all written out.
  std::string text = "function f0(x)\n  return x + 1\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string before = "f" + std::to_string(i - 1);
    text +=
        "function f" + std::to_string(i) + "(x)\n  return " + before + "(x) + " + before + "(x)\n";
  }
  const Outcome outcome = run_program(text + "a = f40(1)\n");
  EXPECT_FALSE(outcome.compiled);
  EXPECT_NE(outcome.messages().find("too-large"), std::string::npos) << outcome.messages();
}

TEST(Limits, NestedLoopsDoNotMultiplyTheWork) {
  std::string text = "a = 0\n", indent;
  for (int i = 0; i < 30; ++i) {
    text += indent + "for i" + std::to_string(i) + " in [1 .. 1]\n";
    indent += " ";
    text += indent + "n" + std::to_string(i) + " = a\n";
  }
  const Outcome outcome = run_program(text + indent + "a += [1 2]\n", {}, {.optimize = false});
  EXPECT_TRUE(outcome.compiled || outcome.messages().find("too-large") != std::string::npos)
      << outcome.messages();
}

}  // namespace
}  // namespace pse::test
