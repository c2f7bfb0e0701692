// The scanner: words, numbers, texts, comments, and how lines begin.
#include <cmath>
#include <limits>

#include "lang/lexer.h"
#include "parsed.h"

namespace pse::test {

using lang::number_value;
using lang::string_value;

TEST(Words, NumbersHaveTheirValues) {
  EXPECT_EQ(number_value("12"), 12.0);
  EXPECT_EQ(number_value(".5"), 0.5);
  EXPECT_EQ(number_value("1."), 1.0);
  EXPECT_EQ(number_value("1.5e3"), 1500.0);
  EXPECT_EQ(number_value("25E-1"), 2.5);
  EXPECT_EQ(number_value("1e+2"), 100.0);
}

TEST(Words, NumbersOutOfRangeGoToInfinityOrZero) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(number_value("1e999"), infinity);
  EXPECT_EQ(number_value("1e-999"), 0.0);
  EXPECT_EQ(number_value("0.0000001e400"), infinity);
  EXPECT_EQ(number_value("10000000e-400"), 0.0);
  EXPECT_EQ(number_value("1e99999999999999999999"), infinity);
  EXPECT_EQ(number_value("1e-99999999999999999999"), 0.0);
  EXPECT_EQ(number_value(std::string(400, '9')), infinity);
  EXPECT_EQ(number_value("0." + std::string(400, '0') + "1"), 0.0);
}

TEST(Words, ANumberAboveTheLargestFloatIsQuestioned) {
  EXPECT_EQ(Parsed("a = 3.4028234e38").summary(), "");
  EXPECT_EQ(Parsed("a = 3.41e38").summary(), "1:5 number-too-large");
  EXPECT_TRUE(Parsed("a = 3.41e38").ok());
}

TEST(Words, RangesKeepTheirDots) {
  EXPECT_EQ(expression("[1..5]"), "(range 1 5)");
  EXPECT_EQ(expression("[1 .. n]"), "(range 1 n)");
  EXPECT_EQ(expression("[1. .. .5]"), "(range 1 0.5)");
  EXPECT_EQ(expression("[n - 1 .. n -1 by -1]"),
            "(range (subtract n 1) (subtract n 1) (negate 1))");
}

TEST(Words, TextsHaveEscapes) {
  EXPECT_EQ(string_value(R"("a\n\t\"\\b")"), "a\n\t\"\\b");
  EXPECT_EQ(string_value("'it\\'s'"), "it's");
  EXPECT_EQ(expression(R"('a "b" # c')"), R"("a \"b\" # c")");
  EXPECT_EQ(Parsed(R"(a = "\q")").summary(), "1:6 bad-escape");
}

TEST(Words, CommentsAreKeptWithTheirPlaces) {
  const Parsed parsed("# one\na = 1 // two  \n   #three\n");
  ASSERT_EQ(parsed.program.comments.size(), 3u);
  EXPECT_EQ(parsed.program.comments[0].text, " one");
  EXPECT_TRUE(parsed.program.comments[0].own_line);
  EXPECT_EQ(parsed.program.comments[1].text, " two");
  EXPECT_FALSE(parsed.program.comments[1].own_line);
  EXPECT_EQ(parsed.program.comments[2].text, "three");
  EXPECT_TRUE(parsed.program.comments[2].own_line);
}

TEST(Words, LineEndsMayBeThoseOfWindows) {
  EXPECT_EQ(tree_of("if a\r\n  b = 1\r\nc = 2\r\n"), "if a\n  set b 1\nset c 2\n");
  EXPECT_EQ(tree_of("\xef\xbb\xbf"
                    "a = 1"),
            "set a 1\n");
}

TEST(Words, ATabReachesToTheNextMultipleOfEight) {
  EXPECT_EQ(tree_of("if a\n\tb = 1\n        c = 2\n"), "if a\n  set b 1\n  set c 2\n");
  EXPECT_EQ(tree_of("if a\n        if b\n                c = 1\n\t\td = 2\n\te = 3\n"),
            "if a\n  if b\n    set c 1\n    set d 2\n  set e 3\n");
  EXPECT_EQ(Parsed("if a\n  \tb = 1\n").summary(), "2:3 mixed-indentation");
}

TEST(Words, ForeignSpellingsAreNamedAndUnderstood) {
  const Parsed parsed("a = b \u2264 2\nc := 3\nd = e & f\n");
  EXPECT_EQ(parsed.summary(), "1:7 foreign-spelling, 2:3 foreign-spelling, 3:7 foreign-spelling");
  EXPECT_EQ(parsed.tree(), "set a (less_equal b 2)\nset c 3\nset d (and e f)\n");
}

TEST(Words, PrintedWithTheirPlaces) {
  SourceMap sources;
  const FileId file = sources.add("t.pse", "if x\n  y = [1 .5]\n");
  EXPECT_EQ(lang::print_tokens(sources, file),
            "1:1       line, indented by 0\n1:1       `if`\n1:4       name x\n"
            "2:3       line, indented by 2\n2:3       name y\n2:5       `=`\n2:7       `[`\n"
            "2:8       number 1\n2:10      number .5\n2:12      `]`\n3:1       end\n");
}

}  // namespace pse::test
