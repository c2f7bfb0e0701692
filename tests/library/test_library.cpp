// The library in the language: its files are in order, and the programs in this folder hold its
// functions to values derived by hand.
#include <filesystem>
#include <fstream>
#include <set>

#include "lang/parser.h"
#include "support/expectations.h"

namespace pse::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> programs_in(const char* folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(PSE_SOURCE_DIR) / folder))
    if (entry.path().extension() == ".pse") names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  return info.param.substr(0, info.param.find('.'));
}

// ---- The files ----------------------------------------------------------------------------------

class LibraryFile : public testing::TestWithParam<std::string> {};

TEST_P(LibraryFile, IsFormatted) {
  SourceMap sources;
  Diagnostics diagnostics;
  const std::string text = text_of(fs::path(PSE_SOURCE_DIR) / "library" / GetParam());
  const FileId file = sources.add(GetParam(), text);
  const lang::Program program = lang::parse(sources, file, diagnostics);
  ASSERT_FALSE(diagnostics.has_errors()) << print_text(diagnostics, sources, false);
  EXPECT_EQ(lang::format(program, sources), text);
}

TEST_P(LibraryFile, OpensWithACommentAndDescribesEachFunction) {
  const std::vector<std::string> lines =
      lines_of(text_of(fs::path(PSE_SOURCE_DIR) / "library" / GetParam()));
  ASSERT_FALSE(lines.empty());
  EXPECT_TRUE(lines.front().starts_with("# "));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (!lines[i].starts_with("function ")) continue;
    EXPECT_TRUE(lines[i - 1].starts_with("# ")) << lines[i];
  }
}

TEST_P(LibraryFile, HasProgramsThatTestEveryFunction) {
  // A function counts as tested when a program here, or another library function, names it.
  std::string uses;
  for (const std::string& name : programs_in("tests/library"))
    uses += text_of(fs::path(PSE_SOURCE_DIR) / "tests/library" / name);
  for (const std::string& line :
       lines_of(text_of(fs::path(PSE_SOURCE_DIR) / "library" / GetParam()))) {
    if (!line.starts_with("function ")) continue;
    const std::string name = line.substr(9, line.find('(') - 9);
    EXPECT_NE(uses.find(name), std::string::npos)
        << name << " is named by no program in tests/library";
  }
}

INSTANTIATE_TEST_SUITE_P(All, LibraryFile, testing::ValuesIn(programs_in("library")), test_name);

TEST(Library, DefinesEachFunctionOnce) {
  std::set<std::string> seen;
  for (const std::string& file : programs_in("library"))
    for (const std::string& line : lines_of(text_of(fs::path(PSE_SOURCE_DIR) / "library" / file))) {
      if (!line.starts_with("function ")) continue;
      EXPECT_TRUE(seen.insert(line.substr(9, line.find('(') - 9)).second) << file << ": " << line;
    }
}

// ---- What the functions give --------------------------------------------------------------------

class LibraryProgram : public testing::TestWithParam<std::string> {};

TEST_P(LibraryProgram, DoesWhatItsCommentsSay) {
  check_program(GetParam(), text_of(fs::path(PSE_SOURCE_DIR) / "tests/library" / GetParam()));
}

INSTANTIATE_TEST_SUITE_P(All, LibraryProgram, testing::ValuesIn(programs_in("tests/library")),
                         test_name);

}  // namespace
}  // namespace pse::test
