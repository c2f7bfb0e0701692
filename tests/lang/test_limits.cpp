// Every limit of the front end, on both sides; and texts made to exhaust it.
#include "lang/lexer.h"
#include "parsed.h"

namespace pse::test {

namespace {

std::string repeated(std::string_view piece, std::size_t times) {
  std::string out;
  out.reserve(piece.size() * times);
  for (std::size_t i = 0; i < times; ++i) out += piece;
  return out;
}

std::string brackets(std::size_t levels) {
  return "a = " + repeated("(", levels) + "1" + repeated(")", levels);
}

std::string blocks(std::size_t levels) {
  std::string out;
  for (std::size_t i = 0; i < levels; ++i) out += std::string(i, ' ') + "if a\n";
  return out + std::string(levels, ' ') + "b = 1\n";
}

}  // namespace

TEST(Limits, Nesting) {
  const lang::ParseLimits limits;
  const auto levels = static_cast<std::size_t>(limits.max_nesting);
  // The expression itself is the first level.
  EXPECT_EQ(Parsed(brackets(levels - 1)).summary(), "");
  EXPECT_EQ(Parsed(brackets(levels)).summary(), "1:205 nested-too-deep");
  EXPECT_EQ(Parsed(blocks(levels - 1)).summary(), "");
  EXPECT_EQ(Parsed(blocks(levels)).summary(), "201:201 nested-too-deep");
  EXPECT_EQ(Parsed("a = " + repeated("-", levels - 1) + "1").summary(), "");
  EXPECT_EQ(Parsed("a = " + repeated("-", levels) + "1").summary(), "1:204 nested-too-deep");
  EXPECT_EQ(Parsed("a = " + repeated("2^", levels - 1) + "1").summary(), "");
  EXPECT_EQ(Parsed("a = " + repeated("2^", levels) + "1").summary(), "1:404 nested-too-deep");
  EXPECT_EQ(Parsed("a = " + repeated("not ", levels - 1) + "b").summary(), "");
  EXPECT_EQ(Parsed("a = " + repeated("not ", levels) + "b").summary(), "1:801 nested-too-deep");
  EXPECT_EQ(Parsed("a = " + repeated("b ? c : ", levels - 1) + "d").summary(), "");
  EXPECT_EQ(Parsed("a = " + repeated("b ? c : ", levels) + "d").summary(),
            "1:1601 nested-too-deep");
}

TEST(Limits, HeightOfOneExpression) {
  const lang::ParseLimits limits;
  const auto height = static_cast<std::size_t>(limits.max_height);
  EXPECT_EQ(Parsed("a = 1" + repeated(" + 1", height - 1)).summary(), "");
  EXPECT_EQ(Parsed("a = 1" + repeated(" + 1", height)).summary(), "1:5 expression-too-long");
  EXPECT_EQ(Parsed("a = b" + repeated(".x", height - 1)).summary(), "");
  EXPECT_EQ(Parsed("a = b" + repeated(".x", height)).summary(), "1:5 expression-too-long");
  EXPECT_EQ(Parsed("a = b" + repeated("[1]", height)).summary(), "1:5 expression-too-long");
  // A long list is flat.
  EXPECT_EQ(Parsed("a = [" + repeated("1 ", 50'000) + "]").summary(), "");
}

TEST(Limits, Nodes) {
  lang::ParseLimits limits;
  limits.max_nodes = 10;
  EXPECT_EQ(Parsed("a = 1\nb = 2\nc = 3\n", limits).summary(), "");
  EXPECT_EQ(Parsed("a = 1\nb = 2\nc = 3\nd = 4\n", limits).summary(), "4:5 program-too-large");
}

TEST(Limits, Words) {
  // Three words and the line's start each.
  EXPECT_EQ(Parsed(repeated("x=\n", lang::max_words / 3 + 2)).diagnostics.all().back().code,
            "program-too-large");
}

TEST(Limits, Bytes) {
  lang::ParseLimits limits;
  limits.max_bytes = 5;
  EXPECT_EQ(Parsed("a = 1", limits).summary(), "");
  EXPECT_EQ(Parsed("a = 12", limits).summary(), "1:1 file-too-large");
}

TEST(Limits, BranchesOfOneIfHaveNone) {
  EXPECT_EQ(Parsed("if a b = 1\n" + repeated("else if a b = 1\n", 5000) + "else b = 2\n").summary(),
            "");
}

TEST(Limits, HostileTextsAreRefused) {
  const std::size_t many = 100'000;
  for (const std::string& text : {
           repeated("(", many),
           repeated("[", many),
           repeated("{", many),
           repeated(")", many),
           repeated("]", many),
           repeated("}", many),
           repeated("([{", many),
           repeated("a(", many),
           repeated("a[", many),
           repeated("if a ", many),
           repeated("if a {", many),
           repeated("else ", many),
           repeated("a+", many),
           repeated("a.", many),
           repeated("-", many),
           repeated("!", many),
           repeated("a?", many),
           repeated("a^", many),
           repeated("/*", many),
           repeated("\"", many),
           repeated("(\n", many),
           repeated("{\n", many),
           repeated("function f(", many),
           repeated("a=b<", many),
           repeated("\xff", many),
           repeated("\xff ", many),
           std::string(many, '\0'),
           repeated("\xc3", many),
           repeated("\xe2\x88\x92", many),
           repeated("\t", many) + "a",
           repeated("a=[[", many),
           repeated("a=1[[b=", many),
       }) {
    const Parsed parsed(text);
    EXPECT_FALSE(parsed.ok() && text.back() != 'a') << text.substr(0, 20);
    EXPECT_LE(parsed.diagnostics.all().size(), 2 * Diagnostics::limit);
    EXPECT_FALSE(parsed.printed().empty() && text.back() != 'a');
  }
}

TEST(Limits, BytesThatAreNoTextAreErrors) {
  EXPECT_EQ(Parsed(std::string("a = 1\0b", 7)).summary(), "1:6 bad-bytes");
  EXPECT_EQ(Parsed("a = \xff\xfe\n").summary(), "1:5 bad-bytes");
  EXPECT_EQ(Parsed("# caf\xe9\na = 1\n").summary(), "1:6 bad-bytes");
  EXPECT_EQ(Parsed("a = \"caf\xe9\"\n").summary(), "1:9 bad-bytes");
  EXPECT_EQ(Parsed("# \xf0\x9f\x94\xa5\na = \"\xc3\xa9\"\n").summary(), "");
}

}  // namespace pse::test
