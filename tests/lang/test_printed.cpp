// The programs that the 1985 paper and the 2002 chapter print are understood as printed: their
// trees, by hand, are beside them.
#include <fstream>
#include <sstream>

#include "parsed.h"

namespace pse::test {

namespace {

std::string read(const std::string& name) {
  std::ifstream stream(PSE_SOURCE_DIR "/tests/lang/printed/" + name, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST(Printed, ProgramsOfThePaperOf1985) {
  EXPECT_EQ(tree_of(read("paper_1985.pse")), read("paper_1985.ast"));
}

TEST(Printed, ActionsOfTheChapterOf2002) {
  EXPECT_EQ(tree_of(read("chapter_2002.pse")), read("chapter_2002.ast"));
}

}  // namespace pse::test
