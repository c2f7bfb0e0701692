// Programs that are refused, or questioned: each file in refused/ says behind the lines concerned
// what is reported there,
//   # error: code @column "part of the suggestion"      # warning: code @column
// and nothing else may be. The column counts characters.
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <nlohmann/json.hpp>

#include "parsed.h"

namespace pse::test {

namespace {

struct Expected {
  std::string severity, code;
  int column = 0;
  std::string suggestion;
};

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<Expected> expectations(const std::string& line) {
  static const std::regex form(R"re(# (error|warning): ([a-z-]+) @([0-9]+)(?: "([^"]*)")?)re");
  std::vector<Expected> result;
  for (std::sregex_iterator at(line.begin(), line.end(), form), end; at != end; ++at)
    result.push_back({(*at)[1], (*at)[2], std::stoi((*at)[3]), (*at)[4]});
  return result;
}

void check(const std::filesystem::path& path) {
  SCOPED_TRACE(path.filename().string());
  const std::string text = read(path);
  const Parsed parsed(text);
  const auto reported = nlohmann::json::parse(print_json(parsed.diagnostics, parsed.sources));
  std::size_t next = 0;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    for (const Expected& expected : expectations(line)) {
      if (next >= reported.size()) {
        ADD_FAILURE() << "line " << number << ": no " << expected.code << "\n" << parsed.printed();
        return;
      }
      const auto& found = reported[next++];
      EXPECT_EQ(found["line"], number) << parsed.printed();
      EXPECT_EQ(found["severity"], expected.severity) << "line " << number;
      EXPECT_EQ(found["code"], expected.code) << "line " << number;
      EXPECT_EQ(found["column"], expected.column) << "line " << number;
      const auto suggestion = found["suggestion"].get<std::string>();
      EXPECT_NE(suggestion.find(expected.suggestion), std::string::npos)
          << "line " << number << ": " << suggestion;
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_EQ(next, reported.size()) << parsed.printed();
}

}  // namespace

TEST(Refused, EachErrorAtItsPlaceWithItsSuggestion) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(PSE_SOURCE_DIR "/tests/lang/refused")) {
    check(entry.path());
    ++files;
  }
  EXPECT_GE(files, 6);
}

TEST(Refused, WhatIsMissingAtALinesEndIsMissingBehindItsLastWord) {
  EXPECT_EQ(Parsed("a = \nb = 1").summary(), "1:4 unexpected-word");
  EXPECT_EQ(Parsed("a = ").summary(), "1:4 unexpected-word");
  EXPECT_EQ(Parsed("a = 1 +   # more\nb = 1").summary(), "1:8 unexpected-word");
  EXPECT_EQ(Parsed("a = \"text\nb = 1").summary(), "1:5 open-string");
  EXPECT_EQ(Parsed("a = \"text").summary(), "1:5 open-string");
}

// Brackets that end at one place are one mistake, and what they swallow is none.
TEST(Refused, OneMistakeIsOneError) {
  EXPECT_EQ(Parsed("a = (1 + (2 * [3\nb = 1").summary(), "1:5 unclosed-bracket");
  EXPECT_EQ(Parsed("R = 1 [[ min = 0\na = R").summary(), "1:7 unclosed-bracket");
  EXPECT_EQ(Parsed("for i in [1 ..\n    a = i\nb = 1").summary(), "1:10 unclosed-bracket");
  EXPECT_EQ(Parsed("a = texture(\"foo").summary(), "1:13 open-string");
  EXPECT_EQ(Parsed("a = f(\"foo, 1)\nb = g(2").summary(), "1:7 open-string, 2:6 unclosed-bracket");
  EXPECT_EQ(Parsed("a = \u201chello\u201d").summary(), "1:5 foreign-spelling");
  EXPECT_EQ(Parsed("a = 1 " + std::string(5000, '@')).summary(), "1:7 bad-character");
  EXPECT_EQ(Parsed("a = " + std::string(1000000, 'a')).summary(), "1:5 name-too-long");
  // A name in other letters is one mistake, wherever it stands.
  EXPECT_EQ(Parsed("gr\u00f6\u00dfe = 3\nif gr\u00f6\u00dfe > 2\n    b = gr\u00f6\u00dfe\n"
                   "\u00e9t\u00e9 = \u6c34\n")
                .summary(),
            "1:1 bad-character, 4:1 bad-character, 4:9 bad-character");
  for (const char* opener : {"(", "[", "if a {"}) {
    std::string text = "a = 1\nb = ";
    if (*opener == 'i') text = "a = 1\n";
    for (int i = 0; i < 10000; ++i) text += opener;
    const std::string summary = Parsed(text).summary();
    EXPECT_TRUE(summary.ends_with(" unclosed-bracket") && summary.find(',') == std::string::npos)
        << summary;
  }
}

// Each bracket is counted, and the text says what to add where.
TEST(Refused, UnclosedBracketsAreCounted) {
  const std::string printed = Parsed("a = (1 + (2 * [3\nb = 1").printed();
  EXPECT_NE(printed.find("`(` is never closed, nor are 2 brackets in it"), std::string::npos);
  EXPECT_NE(printed.find("add `]))` on this line"), std::string::npos) << printed;
  EXPECT_NE(Parsed("a = ((1").printed().find("nor is the bracket in it"), std::string::npos);
}

TEST(Refused, AfterAnErrorTheRestIsRead) {
  const Parsed parsed("a = )\nb = 1\nif c = 2\n  d = (\ne = 3\n");
  EXPECT_EQ(
      parsed.summary(),
      "1:4 unexpected-word, 1:5 stray-bracket, 3:6 assignment-in-condition, 4:7 unclosed-bracket");
  EXPECT_NE(parsed.tree().find("set b 1"), std::string::npos);
  EXPECT_NE(parsed.tree().find("set e 3"), std::string::npos);
}

}  // namespace pse::test
