// Broken files: cut short, with flipped bits, with headers that lie. Each must give an error or an
// image, and nothing else: no crash, no hang, no allocation that the file does not justify. (The
// same, without end: fuzz/image_read.)
#include <algorithm>
#include <cstring>
#include <random>

#include "files.h"

namespace pse::image {
namespace {

using namespace test;

// A file for each way of storing: scan lines and tiles, several compressions, PNG of 8 and 16 bits.
std::vector<std::pair<std::string, Content>> samples() {
  Folder folder;
  std::vector<std::pair<std::string, Content>> list;
  const Image image = numbered({0, 0, 31, 22}, {-2, 1, 29, 23},
                               {{"A", PixelType::float16},
                                {"B", PixelType::float16},
                                {"G", PixelType::float16},
                                {"N.X", PixelType::float32},
                                {"R", PixelType::float16},
                                {"id.Y", PixelType::uint32}});
  for (const auto method : {Compression::none, Compression::rle, Compression::zip, Compression::piz,
                            Compression::pxr24, Compression::b44a, Compression::dwaa})
    for (const int tile : {0, 8}) {
      WriteOptions options;
      options.compression = method;
      options.tile_width = options.tile_height = tile;
      EXPECT_TRUE(write_image(folder / "a.exr", image, options));
      list.emplace_back(
          "exr " + std::to_string(static_cast<int>(method)) + " " + std::to_string(tile),
          content_of(folder / "a.exr"));
    }
  const Image colours =
      numbered({0, 0, 31, 22}, {0, 0, 31, 22},
               {{"R", PixelType::float16}, {"G", PixelType::float16}, {"B", PixelType::float16}});
  for (const int bits : {8, 16}) {
    WriteOptions options;
    options.bits = bits;
    EXPECT_TRUE(write_image(folder / "a.png", colours, options));
    list.emplace_back("png " + std::to_string(bits), content_of(folder / "a.png"));
  }
  return list;
}

ReadOptions strict() {
  ReadOptions options;
  options.limits.max_pixels = 1 << 22;
  options.limits.max_bytes = std::int64_t{1} << 26;
  options.limits.max_band_bytes = std::int64_t{1} << 26;
  return options;
}

Result<Image> read_memory(Content content, const ReadOptions& options = strict()) {
  auto reader = open_reader(bytes_from_memory("the file", std::move(content)), options);
  if (!reader) return std::unexpected(reader.error());
  return read_image(**reader, options.limits);
}

TEST(Damage, CutShortAnywhere) {
  for (const auto& [name, content] : samples()) {
    ASSERT_TRUE(read_memory(content)) << name;
    const std::size_t step = std::max<std::size_t>(1, content.size() / 300);
    for (std::size_t length = 0; length < content.size(); length += step) {
      const auto read = read_memory(
          Content(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(length)));
      // What follows a PNG's last pixel may be missing.
      if (name.starts_with("png") && length + 16 >= content.size()) continue;
      ASSERT_FALSE(read) << name << " cut to " << length;
      EXPECT_FALSE(read.error().message.empty());
      EXPECT_FALSE(read.error().is_output());
      if (length > 400 && name.starts_with("png")) {
        EXPECT_EQ(read.error().kind, ErrorKind::truncated)
            << name << " cut to " << length << message_of(read);
      }
    }
  }
}

TEST(Damage, FlippedBytes) {
  std::mt19937 random(7);
  for (const auto& [name, content] : samples())
    for (int i = 0; i < 300; ++i) {
      Content broken = content;
      // Most of the harm lies in the header.
      const std::size_t reach =
          i % 3 == 0 ? content.size() : std::min<std::size_t>(content.size(), 450);
      for (int n = 0; n <= i % 4; ++n)
        broken[random() % reach] = static_cast<unsigned char>(i % 5 == 0 ? 0xff : random());
      const auto read = read_memory(broken);
      EXPECT_TRUE(read || !read.error().message.empty());
    }
}

TEST(Damage, HeadersThatClaimTooMuch) {
  for (const auto& [name, content] : samples()) {
    if (name.starts_with("png")) continue;
    struct Case {
      std::int32_t x0, y0, x1, y1;
    };
    for (const Case& window :
         {Case{0, 0, 2147483647, 2147483647}, Case{0, 0, 99999, 99999},
          Case{-2147483647 - 1, 0, 2147483647, 0}, Case{0, 0, 0, 2147483647}, Case{5, 5, 4, 4},
          Case{0, 0, 2000, 2000}, Case{0, 0, 4000000, 0}, Case{2147483600, 0, 2147483647, 10}}) {
      Content broken = content;
      const std::int32_t values[4] = {window.x0, window.y0, window.x1, window.y1};
      const std::string head = "dataWindow" + std::string("\0box2i\0\x10\0\0\0", 11);
      const auto at = std::search(broken.begin(), broken.end(), head.begin(), head.end());
      ASSERT_NE(at, broken.end());
      std::memcpy(&*(at + static_cast<std::ptrdiff_t>(head.size())), values, 16);
      const auto read = read_memory(broken);
      ASSERT_FALSE(read) << name << " " << window.x1 << " " << window.y1;
    }
  }
}

TEST(Damage, PngThatClaimsTooMuch) {
  for (auto [name, content] : samples()) {
    if (!name.starts_with("png")) continue;
    // Width and height in the first chunk, with its checksum put right.
    for (const auto& [width, height] : {std::pair{0x7fffffffu, 0x7fffffffu},
                                        {60000u, 60000u},
                                        {2000u, 2000u},
                                        {0u, 5u},
                                        {1u, 0x7fffffffu},
                                        {0x7fffffffu, 1u}}) {
      Content broken = content;
      for (int i = 0; i < 4; ++i) {
        broken[static_cast<std::size_t>(16 + i)] =
            static_cast<unsigned char>(width >> (24 - 8 * i));
        broken[static_cast<std::size_t>(20 + i)] =
            static_cast<unsigned char>(height >> (24 - 8 * i));
      }
      std::uint32_t crc = 0xffffffffu;
      for (std::size_t i = 12; i < 29; ++i) {
        crc ^= broken[i];
        for (int k = 0; k < 8; ++k) crc = (crc & 1) != 0 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
      }
      crc = ~crc;
      for (int i = 0; i < 4; ++i)
        broken[static_cast<std::size_t>(29 + i)] = static_cast<unsigned char>(crc >> (24 - 8 * i));
      EXPECT_FALSE(read_memory(broken)) << width << " x " << height;
    }
  }
}

TEST(Damage, OtherFiles) {
  Folder folder;
  EXPECT_EQ(read_image(folder / "none.exr").error().kind, ErrorKind::not_found);
  EXPECT_EQ(read_image(folder / ".").error().kind, ErrorKind::cannot_read);
  EXPECT_EQ(read_image(std::string("a\0b.exr", 7)).error().kind, ErrorKind::not_found);
  EXPECT_EQ(read_image("").error().kind, ErrorKind::not_found);
  EXPECT_EQ(read_image("/dev/null").error().kind, ErrorKind::cannot_read);
  put_content(folder / "empty.exr", {});
  EXPECT_EQ(read_image(folder / "empty.exr").error().kind, ErrorKind::truncated);
  put_content(folder / "text.exr", Content(1000, 'x'));
  EXPECT_EQ(read_image(folder / "text.exr").error().kind, ErrorKind::not_an_image);
  put_content(folder / "zero.exr", Content(1000, 0));
  EXPECT_EQ(read_image(folder / "zero.exr").error().kind, ErrorKind::not_an_image);
  EXPECT_NE(read_image(folder / "text.exr").error().message.find("text.exr"), std::string::npos);
}

TEST(Damage, EndlessInputIsRefused) {
  ReadOptions options;
  options.limits.max_spool_bytes = 1 << 20;
  EXPECT_EQ(read_image("/dev/zero", options).error().kind, ErrorKind::cannot_read);
}

TEST(Damage, LimitsCanBeLowered) {
  Folder folder;
  const Image image = numbered({0, 0, 40, 30}, {0, 0, 40, 30}, {{"R", PixelType::float16}});
  ASSERT_TRUE(write_image(folder / "a.exr", image));
  ReadOptions options;
  options.limits.max_pixels = 1199;
  EXPECT_EQ(read_image(folder / "a.exr", options).error().kind, ErrorKind::too_large);
  options.limits.max_pixels = 1200;
  EXPECT_TRUE(read_image(folder / "a.exr", options));
  options.limits.max_bytes = 4799;
  EXPECT_EQ(read_image(folder / "a.exr", options).error().kind, ErrorKind::too_large);
}

}  // namespace
}  // namespace pse::image
