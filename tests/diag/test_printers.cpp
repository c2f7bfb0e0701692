// Diagnostics as text and as JSON: carets under tabs, wide letters and bytes that are none, long
// lines, hostile texts.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "diag/diagnostics.h"

namespace pse::test {

namespace {

struct Case {
  SourceMap sources;
  Diagnostics diagnostics;

  // One error at `mark` in the text.
  Case(const std::string& text, const std::string& mark, const std::string& name = "a.pse") {
    const FileId file = sources.add(name, text);
    const std::size_t begin = text.find(mark);
    diagnostics.error(
        "code",
        {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(begin + mark.size())},
        "message", "do this");
  }
  std::string text(bool colour = false) const { return print_text(diagnostics, sources, colour); }
};

}  // namespace

TEST(PrintText, ShowsPlaceLineCaretAndHelp) {
  Case one("a = 1\nb = foo + 2\n", "foo");
  EXPECT_EQ(one.text(),
            "a.pse:2:5: error: message [code]\n"
            "   2 | b = foo + 2\n"
            "     |     ^~~\n"
            "       help: do this\n");
}

TEST(PrintText, ShowsWhatWasExpected) {
  SourceMap sources;
  Diagnostics diagnostics;
  diagnostics.add({Severity::error, "c", "m", {sources.add("f", "a )"), 2, 3}, "a name", {}});
  EXPECT_EQ(print_text(diagnostics, sources, false),
            "f:1:3: error: m [c]\n   1 | a )\n     |   ^\n       expected: a name\n");
}

TEST(PrintText, CaretStandsUnderTabsAndWideLetters) {
  EXPECT_EQ(Case("\tfoo", "foo").text(),
            "a.pse:1:2: error: message [code]\n   1 |         foo\n     |         ^~~\n       "
            "help: do this\n");
  EXPECT_EQ(Case("ab\tfoo", "foo").text(),
            "a.pse:1:4: error: message [code]\n   1 | ab      foo\n     |         ^~~\n       "
            "help: do this\n");
  EXPECT_EQ(Case("\xc3\xa9 foo", "foo").text(),
            "a.pse:1:3: error: message [code]\n   1 | \xc3\xa9 foo\n     |   ^~~\n       help: do "
            "this\n");
  // One letter, two columns.
  EXPECT_EQ(Case("\xe6\xb0\xb4 foo", "foo").text(),
            "a.pse:1:3: error: message [code]\n   1 | \xe6\xb0\xb4 foo\n     |    ^~~\n       "
            "help: do this\n");
  // A letter and its accent, one column.
  EXPECT_EQ(Case("e\xcc\x81 foo", "foo").text(),
            "a.pse:1:4: error: message [code]\n   1 | e\xcc\x81 foo\n     |   ^~~\n       help: do "
            "this\n");
}

TEST(PrintText, AnEmptyPlaceHasOneCaret) {
  SourceMap sources;
  Diagnostics diagnostics;
  const FileId file = sources.add("f", "ab\n");
  diagnostics.error("c", {file, 2, 2}, "m");
  diagnostics.error("c", {file, 3, 3}, "at the end");
  EXPECT_EQ(print_text(diagnostics, sources, false),
            "f:1:3: error: m [c]\n   1 | ab\n     |   ^\nf:2:1: error: at the end [c]\n   2 | \n   "
            "  | ^\n");
}

TEST(PrintText, APlaceOfSeveralLinesIsMarkedToTheEndOfItsFirst) {
  EXPECT_EQ(
      Case("a = (1 +\n  2)\n", "(1 +\n  2)").text(),
      "a.pse:1:5: error: message [code]\n   1 | a = (1 +\n     |     ^~~~\n       help: do this\n");
}

TEST(PrintText, LongLinesAreShownAroundTheCaret) {
  const std::string text =
      Case(std::string(500, 'a') + "foo" + std::string(500, 'b'), "foo").text();
  std::size_t begin = 0;
  std::string source, caret;
  for (int line = 0; line < 3; ++line) {
    const std::size_t end = text.find('\n', begin);
    if (line == 1) source = text.substr(begin, end - begin);
    if (line == 2) caret = text.substr(begin, end - begin);
    begin = end + 1;
  }
  EXPECT_LE(source.size(), 120u);
  EXPECT_TRUE(source.starts_with("   1 | ...aaa")) << source;
  EXPECT_TRUE(source.ends_with("bbb...")) << source;
  EXPECT_EQ(source.find("foo"), caret.find('^')) << text;
  EXPECT_TRUE(text.starts_with("a.pse:1:501: ")) << text;
}

TEST(PrintText, NothingInATextSteersTheTerminal) {
  const std::string text =
      Case("\x1b[31m foo \x07 \xe2\x80\xae \xff\xfe", "foo", "\x1b[2J.pse").text();
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_EQ(text.find('\x07'), std::string::npos);
  EXPECT_EQ(text.find("\xe2\x80\xae"), std::string::npos);
  EXPECT_EQ(text.find('\xff'), std::string::npos);
}

TEST(PrintText, ColourIsAsked) {
  EXPECT_EQ(Case("foo", "foo").text(false).find('\x1b'), std::string::npos);
  EXPECT_NE(Case("foo", "foo").text(true).find("\x1b["), std::string::npos);
}

TEST(PrintText, WithoutAPlaceThereIsOnlyTheMessage) {
  Diagnostics diagnostics;
  diagnostics.warning("c", {}, "m");
  EXPECT_EQ(print_text(diagnostics, SourceMap(), false), "warning: m [c]\n");
}

TEST(PrintText, CountsWhatIsNotShown) {
  SourceMap sources;
  Diagnostics diagnostics;
  for (std::size_t i = 0; i < Diagnostics::limit + 2; ++i) diagnostics.error("c", {}, "m");
  EXPECT_TRUE(print_text(diagnostics, sources, false).ends_with("and 2 more errors\n"));
}

TEST(PrintJson, HoldsEverything) {
  const Case one("a = 1\n\xc3\xa9 = foo + 2\n", "foo + 2\n");
  const auto list = nlohmann::json::parse(print_json(one.diagnostics, one.sources));
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["severity"], "error");
  EXPECT_EQ(list[0]["code"], "code");
  EXPECT_EQ(list[0]["message"], "message");
  EXPECT_EQ(list[0]["file"], "a.pse");
  EXPECT_EQ(list[0]["line"], 2);
  EXPECT_EQ(list[0]["column"], 5);
  EXPECT_EQ(list[0]["end_line"], 3);
  EXPECT_EQ(list[0]["end_column"], 1);
  EXPECT_EQ(list[0]["suggestion"], "do this");
  EXPECT_EQ(list[0]["expected"], "");
}

TEST(PrintJson, SurvivesBytesThatAreNoText) {
  SourceMap sources;
  Diagnostics diagnostics;
  diagnostics.error("c", {sources.add("\xff.pse", "\xff\xfe"), 0, 2}, "m\xc3", "\x80");
  const auto list = nlohmann::json::parse(print_json(diagnostics, sources));
  EXPECT_EQ(list[0]["message"], "m\xef\xbf\xbd");
  EXPECT_EQ(list[0]["end_column"], 3);
}

TEST(PrintJson, WithoutAPlaceTheLineIsNull) {
  Diagnostics diagnostics;
  diagnostics.error("c", {}, "m");
  EXPECT_TRUE(nlohmann::json::parse(print_json(diagnostics, SourceMap()))[0]["line"].is_null());
  EXPECT_EQ(print_json(Diagnostics(), SourceMap()), "[]\n");
}

}  // namespace pse::test
