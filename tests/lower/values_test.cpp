// What programs compute: each statement of the language with an answer derived by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "support/run_program.h"

namespace pse::test {
namespace {

using Values = std::vector<float>;

Values value(const std::string& text, const std::string& name = "a", const Sample& sample = {}) {
  // Optimised and plain must agree; what differs is a bug of a pass.
  const Outcome plain = run_program(text, sample, {.optimize = false});
  const Outcome optimised = run_program(text, sample);
  EXPECT_TRUE(plain.compiled) << text << "\n" << plain.messages();
  EXPECT_TRUE(optimised.compiled) << text << "\n" << optimised.messages();
  if (!plain.compiled || !optimised.compiled) return {};
  EXPECT_EQ(plain.failed_check, "") << text;
  const auto found = optimised.values.find(name);
  if (found == optimised.values.end()) {
    ADD_FAILURE() << "no output " << name << " in\n" << text;
    return {};
  }
  EXPECT_EQ(plain.values.at(name), found->second) << text;
  return found->second;
}

TEST(Values, ArithmeticAndPrecedence) {
  EXPECT_EQ(value("a = 1 + 2 * 3"), Values{7});
  EXPECT_EQ(value("a = (1 + 2) * 3"), Values{9});
  EXPECT_EQ(value("a = -2 ^ 2"), Values{-4});
  EXPECT_EQ(value("a = 2 ^ 3 ^ 1"), Values{8});
  EXPECT_EQ(value("a = 7 % 3"), Values{1});
  EXPECT_EQ(value("a = -1 % 3"), Values{2});
  EXPECT_EQ(value("a = 1 / 0"), Values{INFINITY});
  EXPECT_EQ(value("a = 10 - 4 - 3"), Values{3});
}

// Powers known when compiling that are roots or the reciprocal: with the special cases of pow.
TEST(Values, RootsAsPowers) {
  const float inf = INFINITY;
  for (const float x : {0.0f, -0.0f, 4.0f, 2.0f, 1e-40f, 3e38f, -1.0f, inf, -inf, std::nanf("")})
    for (const float power : {0.5f, 0.25f, -1.0f}) {
      const Sample sample{.stream = {{"k", {x}}}, .frame = {}, .knobs = {}};
      const Outcome outcome = run_program("a = k ^ " + std::to_string(power), sample);
      const float found = outcome.number("a"), expected = std::pow(x, power);
      if (std::isnan(expected))
        EXPECT_TRUE(std::isnan(found)) << x << " ^ " << power;
      else
        EXPECT_FLOAT_EQ(found, expected) << x << " ^ " << power;
      EXPECT_EQ(std::signbit(found) && !std::isnan(found),
                std::signbit(expected) && !std::isnan(expected))
          << x << " ^ " << power;
    }
}

TEST(Values, VectorsTakeNumbersComponentByComponent) {
  EXPECT_EQ(value("a = [1 2 3] * 2"), (Values{2, 4, 6}));
  EXPECT_EQ(value("a = 1 - [1, 2, 3]"), (Values{0, -1, -2}));
  EXPECT_EQ(value("a = [1 2] * [3 4]"), (Values{3, 8}));
  EXPECT_EQ(value("a = -[1 -2 3]"), (Values{-1, 2, -3}));
  EXPECT_EQ(value("p = [1 2 3]\na = [p.xy 9]"), (Values{1, 2, 9}));
}

TEST(Values, ComponentsCountFromOne) {
  EXPECT_EQ(value("p = [5 6 7]\na = p[1] + 10 * p[3]"), Values{75});
  EXPECT_EQ(value("p = [5 6 7]\na = p.zyx"), (Values{7, 6, 5}));
  EXPECT_EQ(value("p = [5 6 7]\np.y = 1\np[3] += 2\na = p"), (Values{5, 1, 9}));
  EXPECT_EQ(value("p = [5 6 7]\np.xz = [1 2]\na = p"), (Values{1, 6, 2}));
  EXPECT_EQ(value("p = [5 6 7]\na = p[k]", "a", {.stream = {{"k", {2}}}, .frame = {}, .knobs = {}}),
            Values{6});
}

TEST(Values, MatricesMultiply) {
  EXPECT_EQ(value("m = [[1 2] [3 4]]\na = m * [5 6]"), (Values{17, 39}));
  EXPECT_EQ(value("m = [[1 2] [3 4]]\na = [5 6] * m"), (Values{23, 34}));
  EXPECT_EQ(value("m = [[1 2] [3 4]]\na = m * m"), (Values{7, 10, 15, 22}));
  EXPECT_EQ(value("m = [[1 2] [3 4]]\na = transpose(m)[1]"), (Values{1, 3}));
  EXPECT_EQ(value("m = [[1 2] [3 4]]\na = m[2, 1]"), Values{3});
  EXPECT_EQ(value("m = [[1 2] [3 4]]\nm[2, 1] = 9\nm[1] = [7 8]\na = m"), (Values{7, 8, 9, 4}));
}

TEST(Values, ConditionsAndChoice) {
  EXPECT_EQ(value("a = 3 > 2 ? 10 : 20"), Values{10});
  EXPECT_EQ(value("a = not (1 < 2) or 3 == 3"), Values{1});
  EXPECT_EQ(value("a = 1 < 2 and 2 < 1"), Values{0});
  EXPECT_EQ(value("if k > 1\n  a = 5\nelse if k > 0\n  a = 6\nelse\n  a = 7", "a",
                  {.stream = {{"k", {0.5f}}}, .frame = {}, .knobs = {}}),
            Values{6});
  EXPECT_EQ(value("a = 1\nif k > 0 { a = [1 2 3] }", "a",
                  {.stream = {{"k", {-1}}}, .frame = {}, .knobs = {}}),
            (Values{1, 1, 1}));
}

TEST(Values, Loops) {
  EXPECT_EQ(value("a = 0\nfor i in [1 .. 4]\n  a += i"), Values{10});
  EXPECT_EQ(value("a = 0\nfor i in [10 .. 1 by -3]\n  a = 10 * a + i"), Values{10741});
  EXPECT_EQ(value("a = 1\nwhile a < 100\n  a *= 3"), Values{243});
  EXPECT_EQ(value("a = 0\nfor c in [5 6 7]\n  a = 10 * a + c"), Values{567});
  EXPECT_EQ(value("a = 0\nfor i in [1 .. 0]\n  a = 1"), Values{0});
  EXPECT_EQ(value("t = 0\nfor i in [1 .. 3]\n  t += [i 1]\na = t"), (Values{6, 3}));
}

TEST(Values, BreakAndContinue) {
  EXPECT_EQ(value("a = 0\nfor i in [1 .. 10]\n  if i == 3\n    continue\n  if i > 5\n    break\n  "
                  "a = 10 * a + i"),
            Values{1245});
  EXPECT_EQ(value("a = 0\nfor i in [1 .. 3]\n  for j in [1 .. 3]\n    if j > i\n      break\n    a "
                  "+= 1\n  a *= 10"),
            Values{1230});
  EXPECT_EQ(value("a = 0\nwhile true\n  a += 1\n  if a >= 7 { break }"), Values{7});
}

TEST(Values, FunctionsAreMadeForTheTypesTheyAreCalledWith) {
  EXPECT_EQ(value("function twice(x)\n  return x + x\na = [twice(3) twice([1 2])]"),
            (Values{6, 2, 4}));
  EXPECT_EQ(value("function f(x, y = 10)\n  return x + y\na = f(1) + f(1, y = 2)"), Values{14});
  EXPECT_EQ(value("function apply(g, x)\n  return g(g(x))\nfunction inc(x)\n  return x + 1\na = "
                  "apply(inc, 5)"),
            Values{7});
  EXPECT_EQ(value("function outer(x)\n  return x * Scale\nScale = 3\na = outer(2)"), Values{6});
}

TEST(Values, AFunctionMayBeUsedInsideTheFunctionItIsGiven) {
  EXPECT_EQ(value("function twice(f, x)\n  return f(f(x))\nfunction inc(x)\n  return x + 1\n"
                  "function add_two(x)\n  return twice(inc, x)\na = twice(add_two, 1)"),
            Values{5});
}

TEST(Values, EarlyReturns) {
  const std::string text =
      "function f(x)\n  if x < 0\n    return -1\n  if x > 10 return 1\n  for i in [1 .. 10]\n    "
      "if i * i > x\n"
      "      return i\n  return 99\n";
  EXPECT_EQ(value(text + "a = [f(-5) f(11) f(8) f(0)]"), (Values{-1, 1, 3, 1}));
  EXPECT_EQ(value("function g(x)\n  if x > 0\n    if x > 1\n      return 2\n    y = 5\n  else\n    "
                  "y = 6\n  return y\n"
                  "a = [g(2) g(0.5) g(-1)]"),
            (Values{2, 5, 6}));
}

TEST(Values, ArraysGrowByAssignment) {
  EXPECT_EQ(value("function make(n)\n  for i in [1 .. n]\n    c[i] = i * i\n  return c\n"
                  "s = make(4)\na = 0\nfor v in s\n  a += v"),
            Values{30});
  EXPECT_EQ(value("b[3] = 7\na = [count(b) b[1] b[3]]"), (Values{3, 0, 7}));
  EXPECT_EQ(value("b[1] = [1 2]\nb[2] = [3 4]\nc = b\nc[1] = [9 9]\na = [b[1] c[1]]"),
            (Values{1, 2, 9, 9}));
}

TEST(Values, ReadingOutsideAnArrayIsAnErrorWithALine) {
  const Outcome outcome =
      run_program("b[1] = 5\na = b[k]", {.stream = {{"k", {2}}}, .frame = {}, .knobs = {}});
  EXPECT_TRUE(outcome.compiled) << outcome.messages();
  EXPECT_EQ(outcome.failed_check, "2: index of `b` is outside the array");
}

TEST(Values, TheStreamIsReadAndSet) {
  const Sample sample{.stream = {{"normal", {1, 2, 3}}}, .frame = {{"frame", {5}}}, .knobs = {}};
  EXPECT_EQ(value("normal += [10 20 30]\na = frame", "normal", sample), (Values{11, 22, 33}));
  EXPECT_EQ(value("if frame > 3 { normal = normal * 2 }", "normal", sample), (Values{2, 4, 6}));
}

TEST(Values, KnobsComeFromOutside) {
  EXPECT_EQ(value("Radius = 0.5 [[ min = 0, max = 1 ]]\na = Radius * 2"), Values{1});
  EXPECT_EQ(value("Radius = 0.5\na = Radius * 2", "a",
                  {.stream = {}, .frame = {}, .knobs = {{"Radius", {4}}}}),
            Values{8});
  EXPECT_EQ(value("Tint = [1 0.5 0]\na = Tint", "a",
                  {.stream = {}, .frame = {}, .knobs = {{"Tint", {1, 2, 3}}}}),
            (Values{1, 2, 3}));
}

TEST(Values, ConstantsOfImportedFilesAreKnobs) {
  const RunSettings settings{
      .modules = {
          {"shapes", "Size = 3\nTwice = 1\nTwice = 2\nfunction area(r)\n  return Size * r\n"},
          {"more", "Size = 7\nfunction more_size() return Size\n"}}};
  const auto a = [&](const char* text, const char* knob, float value) {
    Outcome outcome =
        run_program(text, {.stream = {}, .frame = {}, .knobs = {{knob, {value}}}}, settings);
    EXPECT_TRUE(outcome.compiled) << outcome.messages();
    return outcome.number("a");
  };
  EXPECT_EQ(a("import shapes\na = area(2)", "Size", 5), 10);
  EXPECT_EQ(a("import shapes as s\na = s.Size + s.area(1)", "Size", 5), 10);
  // The program's own keeps the name; the file's is told apart by the file's.
  EXPECT_EQ(a("import shapes\nSize = 1\na = area(2) + Size", "Size", 5), 11);
  EXPECT_EQ(a("import shapes\nSize = 1\na = area(2) + Size", "shapes.Size", 5), 11);
  EXPECT_EQ(a("import shapes\nimport more\na = 100 * area(1) + more_size()", "more.Size", 4), 304);
  // Of what a file sets twice, the last counts.
  EXPECT_EQ(a("import shapes\na = Twice", "Nothing", 0), 2);
  EXPECT_EQ(a("import shapes\na = Twice", "Twice", 5), 5);
}

TEST(Values, OwnFunctionsComeBeforeTheStreamsNames) {
  EXPECT_EQ(value("function place(t) return 2 * t\nfunction twice(f, t) return f(f(t))\na = "
                  "twice(place, 3)",
                  "a", {.stream = {{"place", {1, 2, 3}}}, .frame = {}, .knobs = {}}),
            Values{12});
}

TEST(Values, NamedColoursAreConstants) {
  EXPECT_EQ(value("Tint = 0.5 * red\na = Tint", "a",
                  {.stream = {}, .frame = {}, .knobs = {{"Tint", {1, 2, 3}}}}),
            (Values{1, 2, 3}));
}

TEST(Values, BeginFrameComputesOncePerFrame) {
  EXPECT_EQ(value("function makewaves(n)\n  for i in [1 .. n]\n    center[i] = i * [100 0 0]\n  "
                  "return center\n"
                  "if begin_frame\n  center = makewaves(20)\nfor c in center\n  normal += c",
                  "normal", {.stream = {{"normal", {0, 0, 1}}}, .frame = {}, .knobs = {}}),
            (Values{21000, 0, 1}));
}

TEST(Values, ModulesAreFoundByName) {
  const RunSettings settings{
      .modules = {{"shapes", "Size = 3\nfunction area(r)\n  return Size * r\n"}}};
  Outcome open = run_program("import shapes\na = area(2)", {}, settings);
  ASSERT_TRUE(open.compiled) << open.messages();
  EXPECT_EQ(open.number("a"), 6);
  Outcome named = run_program("import shapes as s\na = s.area(s.Size)", {}, settings);
  ASSERT_TRUE(named.compiled) << named.messages();
  EXPECT_EQ(named.number("a"), 9);
}

}  // namespace
}  // namespace pse::test
