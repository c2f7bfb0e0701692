// Frame lists and file patterns, by tables.
#include "files.h"
#include "image/sequence.h"

namespace pse::image {
namespace {

using namespace test;

TEST(Frames, Lists) {
  const std::vector<std::pair<const char*, std::vector<int>>> table = {
      {"7", {7}},
      {"1-4", {1, 2, 3, 4}},
      {"1-10x5", {1, 6}},
      {"1-11:5", {1, 6, 11}},
      {"1,5,9", {1, 5, 9}},
      {"4-1", {4, 3, 2, 1}},
      {"10-1x4", {10, 6, 2}},
      {"-2-1", {-2, -1, 0, 1}},
      {"-4--2", {-4, -3, -2}},
      {"-5", {-5}},
      {" 1 , 3-4 ", {1, 3, 4}},
      {"1-3,2-5", {1, 2, 3, 4, 5}},
      {"0-0", {0}},
      {"2147483647", {2147483647}},
  };
  for (const auto& [text, frames] : table) {
    const auto parsed = parse_frames(text);
    ASSERT_TRUE(parsed) << text << ": " << parsed.error();
    EXPECT_EQ(*parsed, frames) << text;
  }
}

TEST(Frames, WrongLists) {
  for (const char* text :
       {"",     " ",   "a",     "1-",          "-",         "1,,2",
        "1,",   ",1",  "1-2x0", "1-2x-1",      "1-2x",      "1x2",
        "1..5", "1.5", "1-2-3", "99999999999", "1-2000000", "-2147483648-2147483647",
        "1 2",  "+1",  "0x10"}) {
    const auto parsed = parse_frames(text);
    EXPECT_FALSE(parsed) << text;
    EXPECT_TRUE(parsed || parsed.error().size() > 20);
  }
}

TEST(Frames, Names) {
  const std::vector<std::tuple<const char*, int, const char*>> table = {
      {"a.%04d.exr", 7, "a.0007.exr"},
      {"a.####.exr", 7, "a.0007.exr"},
      {"a.#.exr", 7, "a.0007.exr"},
      {"a.##.exr", 123, "a.123.exr"},
      {"a%d.exr", 7, "a7.exr"},
      {"a.%04d.exr", -7, "a.-007.exr"},
      {"dir#/a.exr", 12, "dir0012/a.exr"},
      {"100%%.%d.exr", 3, "100%.3.exr"},
      {"a.exr", 9, "a.exr"},
      {"a.%04d.exr", 123456, "a.123456.exr"}};
  for (const auto& [pattern, frame, name] : table) {
    const auto made = frame_name(pattern, frame);
    ASSERT_TRUE(made) << pattern;
    EXPECT_EQ(*made, name);
  }
  EXPECT_EQ(*canonical_pattern("a.#.exr"), "a.%04d.exr");
  EXPECT_EQ(*canonical_pattern("a.###.exr"), "a.%03d.exr");
  EXPECT_TRUE(is_pattern("a.#.exr"));
  EXPECT_FALSE(is_pattern("a.exr"));
  EXPECT_FALSE(is_pattern("100%%.exr"));
}

TEST(Frames, WrongPatterns) {
  for (const char* pattern :
       {"a.%s.exr", "a%.exr", "a.#.#.exr", "a.%04d.####.exr", "a.%4d.exr", "a.%099d.exr", "50%"})
    EXPECT_FALSE(frame_name(pattern, 1)) << pattern;
}

TEST(Frames, FilesThatExist) {
  Folder folder;
  for (const char* name : {"a.0003.exr", "a.0001.exr", "a.0x01.exr", "a.12.exr", "a.00010.exr",
                           "b.0002.exr", "a.10000.exr", "a.-001.exr"})
    put_content(folder / name, {1});
  EXPECT_EQ(existing_frames(folder / "a.####.exr"), (std::vector<int>{-1, 1, 3, 10000}));
  EXPECT_TRUE(existing_frames(folder / "none/a.#.exr").empty());
}

}  // namespace
}  // namespace pse::image
