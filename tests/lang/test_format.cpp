// The formatter: layout, comments, and its two promises: the tree stays, and formatting twice
// changes nothing more.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "parsed.h"
#include "support/random_program.h"

namespace pse::test {

namespace {

std::string formatted(const std::string& text) {
  const Parsed parsed(text);
  EXPECT_TRUE(parsed.ok()) << text << parsed.printed();
  return parsed.formatted();
}

// Holds a program to the promises.
void check_promises(const std::string& text) {
  const Parsed before(text);
  if (!before.ok()) return;
  const std::string once = before.formatted();
  const Parsed after(once);
  ASSERT_TRUE(after.ok()) << text << "----\n" << once << after.printed();
  ASSERT_EQ(before.tree(), after.tree()) << text << "----\n" << once;
  ASSERT_EQ(once, after.formatted()) << text;
  ASSERT_EQ(before.program.comments.size(), after.program.comments.size()) << text << "----\n"
                                                                           << once;
}

}  // namespace

TEST(Format, SpacesAndIndentation) {
  EXPECT_EQ(formatted("f=1\nwhile f<pixel_freq\n  normal+=Dnoise(f*point)\n  f*=2"),
            "f = 1\nwhile f < pixel_freq\n    normal += Dnoise(f * point)\n    f *= 2\n");
  EXPECT_EQ(formatted("a = -b**2 && !c||d[ 1,2 ] . x"), "a = -b ^ 2 and not c or d[1, 2].x\n");
  EXPECT_EQ(formatted("a = ( b )?(c,d):[1..n by 2]"), "a = (b) ? (c, d) : [1 .. n by 2]\n");
  EXPECT_EQ(formatted("function f( a,b=2 ):\n\treturn a"), "function f(a, b = 2)\n    return a\n");
  EXPECT_EQ(formatted("a = 'say \"x\"'"), "a = \"say \\\"x\\\"\"\n");
}

TEST(Format, VectorsKeepTheirCommas) {
  EXPECT_EQ(formatted("a = [1  -2   3]"), "a = [1 -2 3]\n");
  EXPECT_EQ(formatted("a = [1,-2,3,]"), "a = [1, -2, 3]\n");
  EXPECT_EQ(formatted("a = [b-1 c]"), "a = [b - 1 c]\n");
  EXPECT_EQ(formatted("a = [b -1, c]"), "a = [b - 1, c]\n");
}

TEST(Format, BlocksStayAsTheyAre) {
  EXPECT_EQ(formatted("if (a) return 0\nelse return 1"), "if (a) return 0\nelse return 1\n");
  EXPECT_EQ(formatted("if a then b = 1"), "if a: b = 1\n");
  EXPECT_EQ(formatted("if a {b = 1;c = 2} else {d = 3}"), "if a { b = 1; c = 2 } else { d = 3 }\n");
  EXPECT_EQ(formatted("if a\n{\nb = 1\n}\nelse\n{\nc = 1\n}"),
            "if a {\n    b = 1\n} else {\n    c = 1\n}\n");
  EXPECT_EQ(formatted("if a {\n}"), "if a {\n}\n");
  EXPECT_EQ(formatted("action a {(X,1),(Y,2)}"), "action a { (X, 1), (Y, 2) }\n");
  EXPECT_EQ(formatted("action a {\n T = 1;\n (X,1),\n jitter .3\n}"),
            "action a {\n    T = 1\n    (X, 1)\n    jitter .3\n}\n");
  EXPECT_EQ(formatted("a = 1; b = 2"), "a = 1\nb = 2\n");
}

TEST(Format, ABodyOnTheHeadsLineNeverReadsAsPartOfTheHead) {
  for (const char* text :
       {"if a: -b", "if a: (b, c)", "if (a): [1 2]", "while a: (f)", "if a: then = 1",
        "if a: not b", "function f(x): (x)", "if a: b\nelse: (c)", "for i in a: (b)"})
    check_promises(text);
  EXPECT_EQ(formatted("if (a) b = 1"), "if (a) b = 1\n");
  EXPECT_EQ(formatted("if (a): -b"), "if (a): -b\n");
}

TEST(Format, CommentsAndBlankLinesStay) {
  const std::string text =
      "# head\n\n# second\na = 1  # one\n\nif a  # if\n    # inside\n    b = 2  # two\n    # last "
      "inside\n"
      "# outside\nelse  # else\n    c = 3\n\n# before d\nd = 4\n\n# end\n";
  EXPECT_EQ(formatted(text), text);
  EXPECT_EQ(formatted("\n\na = 1\n\n\n\nb = 2\n\n"), "a = 1\n\nb = 2\n");
  EXPECT_EQ(formatted("if a { # open\n b = 1 # x\n # end\n} # close\n# next\nelse { c = 1 }"),
            "if a {  # open\n    b = 1  # x\n    # end\n}  # close\n# next\nelse { c = 1 }\n");
  EXPECT_EQ(formatted("#only"), "#only\n");
  EXPECT_EQ(formatted(""), "");
}

TEST(Format, WhatHoldsCommentsInBracketsStaysAsWritten) {
  const std::string text = "a = [[1 0 0]   # red\n     [0 1 0]]  # green\n";
  EXPECT_EQ(formatted(text), text);
  check_promises("if f(a, # one\n   b)\n    c  =  1\n");
  check_promises("function f(a, # one\n b) return a\n");
  check_promises("R = 1 [[ min = 0, # low\n max = 1 ]]\n");
}

TEST(Format, LongLinesBreakInBrackets) {
  const std::string row = "[0.123 0.456 0.789]";
  std::string rows;
  for (int i = 0; i < 7; ++i) rows += " " + row;
  EXPECT_EQ(formatted("color = spline(t, [" + rows + "])"),
            "color = spline(t, [\n    " + row + " " + row + " " + row + " " + row + "\n    " + row +
                " " + row + " " + row + "\n])\n");
  const std::string name(40, 'n');
  EXPECT_EQ(formatted("a = f(" + name + ", " + name + ", " + name + ")"),
            "a = f(\n    " + name + ", " + name + ",\n    " + name + "\n)\n");
  std::istringstream lines(formatted("if a { b = [" + rows + " " + rows + "] }"));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
}

TEST(Format, PromisesHoldForEveryProgramHere) {
  int files = 0;
  for (const char* folder : {"gallery", "library", "tests"}) {
    const std::filesystem::path root = std::filesystem::path(PSE_SOURCE_DIR) / folder;
    if (!std::filesystem::exists(root)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      if (entry.path().extension() != ".pse") continue;
      std::ifstream stream(entry.path(), std::ios::binary);
      std::stringstream text;
      text << stream.rdbuf();
      SCOPED_TRACE(entry.path().string());
      check_promises(text.str());
      ++files;
    }
  }
  EXPECT_GE(files, 10);
}

TEST(Format, PromisesHoldForRandomPrograms) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const RandomProgram program(seed);
    EXPECT_TRUE(Parsed(program.text()).ok()) << program.text() << Parsed(program.text()).printed();
    check_promises(program.text());
    if (HasFailure()) return;
  }
}

TEST(Format, RandomProgramsAreTheSameForTheSameSeed) {
  EXPECT_EQ(RandomProgram(7).text(), RandomProgram(7).text());
  EXPECT_NE(RandomProgram(7).text(), RandomProgram(8).text());
}

}  // namespace pse::test
