// Every program in the documents is run: the blocks marked `pse` of README.md and docs/*.md are
// held to their comments.
#include <filesystem>
#include <fstream>
#include <map>

#include "support/expectations.h"

namespace pse::test {
namespace {

struct Block {
  std::string place;  // "docs/language.md:12"
  std::string text;
  std::map<std::string, std::string> modules;  // those defined earlier in the same document
};

void PrintTo(const Block& block, std::ostream* stream) { *stream << block.place; }

std::vector<Block> blocks_of(const std::filesystem::path& root, const std::string& document) {
  std::ifstream file(root / document);
  std::vector<Block> blocks;
  std::map<std::string, std::string> modules;
  std::string line, text, module;
  int number = 0, begin = 0;
  bool inside = false, other = false;
  while (std::getline(file, line)) {
    ++number;
    if (inside && line.starts_with("```")) {
      if (module.empty())
        blocks.push_back({document + ":" + std::to_string(begin), text, modules});
      else
        modules[module] = text;
      inside = false;
    } else if (inside) {
      text += line + "\n";
    } else if (!other && (line == "```pse" || line.starts_with("```pse "))) {
      inside = true;
      begin = number + 1;
      text.clear();
      const std::size_t at = line.find("module=");
      module = at == std::string::npos ? "" : line.substr(at + 7);
    } else if (line.starts_with("```")) {
      other = !other;
    }
  }
  EXPECT_FALSE(inside) << document << ": the last block is not closed";
  return blocks;
}

std::vector<Block> all_blocks() {
  const std::filesystem::path root = PSE_SOURCE_DIR;
  std::vector<std::string> documents = {"README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md")
      documents.push_back("docs/" + entry.path().filename().string());
  std::sort(documents.begin(), documents.end());
  std::vector<Block> blocks;
  for (const std::string& document : documents)
    for (Block& block : blocks_of(root, document)) blocks.push_back(std::move(block));
  return blocks;
}

class Documents : public testing::TestWithParam<Block> {};

TEST_P(Documents, ProgramDoesWhatItsCommentsSay) {
  check_program(GetParam().place, GetParam().text, GetParam().modules);
}

INSTANTIATE_TEST_SUITE_P(All, Documents, testing::ValuesIn(all_blocks()), [](const auto& block) {
  std::string name = block.param.place;
  for (char& letter : name)
    if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
  return name;
});

TEST(DocumentsThemselves, ManualHasManyPrograms) {
  EXPECT_GT(blocks_of(PSE_SOURCE_DIR, "docs/language.md").size(), 30u);
}

}  // namespace
}  // namespace pse::test
