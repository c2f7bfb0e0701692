// EXR in and out: round trips, windows, tiles, rows in pieces, and the real files.
#include <bit>
#include <cmath>
#include <limits>

#include "files.h"

namespace pse::image {
namespace {

using namespace test;

const std::vector<Channel> rgba_and_data = {{"A", PixelType::float16},  {"B", PixelType::float16},
                                            {"G", PixelType::float16},  {"N.X", PixelType::float32},
                                            {"R", PixelType::float16},  {"Z", PixelType::float32},
                                            {"id.Y", PixelType::uint32}};

void expect_same_bits(const Image& a, const Image& b) {
  ASSERT_EQ(a.spec.data, b.spec.data);
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (std::size_t c = 0; c < a.planes.size(); ++c) {
    ASSERT_EQ(a.spec.channels[c].name, b.spec.channels[c].name);
    ASSERT_EQ(a.spec.channels[c].type, b.spec.channels[c].type);
    for (std::size_t i = 0; i < a.planes[c].size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a.planes[c][i]),
                std::bit_cast<std::uint32_t>(b.planes[c][i]))
          << a.spec.channels[c].name << " at " << i;
  }
}

TEST(Exr, EveryCompressionWithoutLossKeepsEveryBit) {
  Folder folder;
  Image image = numbered({0, 0, 40, 30}, {0, 0, 40, 30}, rgba_and_data);
  for (auto& value : image.planes[6]) value = std::floor(value * 100);
  for (const auto method : {Compression::none, Compression::rle, Compression::zips,
                            Compression::zip, Compression::piz}) {
    for (const int tile : {0, 16}) {
      WriteOptions options;
      options.compression = method;
      options.tile_width = options.tile_height = tile;
      auto written = write_image(folder / "a.exr", image, options);
      ASSERT_TRUE(written) << message_of(written);
      auto read = read_image(folder / "a.exr");
      ASSERT_TRUE(read) << message_of(read);
      expect_same_bits(image, *read);
    }
  }
  EXPECT_EQ(folder.entries(), 1);
}

TEST(Exr, WindowsAreKept) {
  Folder folder;
  const Image image = numbered({0, 0, 64, 48}, {-5, 7, 20, 60}, rgba_and_data);
  ASSERT_TRUE(write_image(folder / "a.exr", image));
  auto read = read_image(folder / "a.exr");
  ASSERT_TRUE(read) << message_of(read);
  EXPECT_EQ(read->spec.display, (Window{0, 0, 64, 48}));
  EXPECT_EQ(read->spec.data, (Window{-5, 7, 20, 60}));
  EXPECT_EQ(read->at(0, 0, 0), 0.0f);
  EXPECT_EQ(read->at(1, -4, 9), 1.0f + 1 / 16.0f + 2 / 256.0f);
}

TEST(Exr, SpecialNumbersSurvive) {
  Folder folder;
  Image image =
      numbered({0, 0, 4, 1}, {0, 0, 4, 1}, {{"A", PixelType::float16}, {"f", PixelType::float32}});
  const float inf = std::numeric_limits<float>::infinity();
  for (auto& plane : image.planes) plane = {inf, -inf, std::nanf(""), -0.0f};
  ASSERT_TRUE(write_image(folder / "a.exr", image));
  auto read = read_image(folder / "a.exr");
  ASSERT_TRUE(read) << message_of(read);
  for (const auto& plane : read->planes) {
    EXPECT_EQ(plane[0], inf);
    EXPECT_EQ(plane[1], -inf);
    EXPECT_TRUE(std::isnan(plane[2]));
    EXPECT_TRUE(plane[3] == 0 && std::signbit(plane[3]));
  }
}

// The largest half is 65504; what is beyond it stays finite.
TEST(Exr, NumbersBeyondHalfAreCutToItsLargest) {
  Folder folder;
  Image image = numbered({0, 0, 3, 1}, {0, 0, 3, 1}, {{"R", PixelType::float16}});
  image.planes[0] = {1e9f, -1e9f, 65504.0f};
  ASSERT_TRUE(write_image(folder / "a.exr", image));
  auto read = read_image(folder / "a.exr");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->planes[0], (std::vector<float>{65504.0f, -65504.0f, 65504.0f}));
}

TEST(Exr, RowsInAnyPiecesAndOrder) {
  Folder folder;
  const Image image = numbered({0, 0, 33, 70}, {2, -3, 35, 67}, rgba_and_data);
  for (const int tile : {0, 16}) {
    WriteOptions options;
    options.tile_width = options.tile_height = tile;
    ASSERT_TRUE(write_image(folder / "a.exr", image, options));
    auto reader = open_reader(folder / "a.exr");
    ASSERT_TRUE(reader) << message_of(reader);
    const std::vector<int> channels = {5, 0};
    for (const auto& [from, to] : {std::pair{-3, 1}, {40, 67}, {1, 40}, {5, 6}, {5, 5}}) {
      std::vector<float> z(33 * 80), a(33 * 80);
      const std::vector<float*> planes = {z.data(), a.data()};
      auto done = (*reader)->read_rows(from, to, channels, planes);
      ASSERT_TRUE(done) << message_of(done);
      for (int y = from; y < to; ++y)
        for (int x = 2; x < 35; ++x) {
          ASSERT_EQ(z[static_cast<std::size_t>((y - from) * 33 + x - 2)], image.at(5, x, y));
          ASSERT_EQ(a[static_cast<std::size_t>((y - from) * 33 + x - 2)], image.at(0, x, y));
        }
    }
    std::vector<float> outside(33 * 80);
    const std::vector<float*> planes = {outside.data(), outside.data()};
    EXPECT_FALSE((*reader)->read_rows(-4, 1, channels, planes));
    EXPECT_FALSE((*reader)->read_rows(60, 68, channels, planes));
  }
}

// Tiles of 16 x 16 of a 40 x 20 image, each row of tiles in a shuffled order.
TEST(Exr, FedByTiles) {
  Folder folder;
  const Image image = numbered({0, 0, 40, 20}, {0, 0, 40, 20}, rgba_and_data);
  auto writer = open_writer(folder / "a.exr", image.spec);
  ASSERT_TRUE(writer);
  for (int y = 0; y < 20; y += 16)
    for (const int x : {16, 32, 0}) {
      const Window tile{x, y, std::min(x + 16, 40), std::min(y + 16, 20)};
      std::vector<std::vector<float>> planes(image.planes.size());
      std::vector<const float*> pointers;
      for (std::size_t c = 0; c < planes.size(); ++c) {
        for (int ty = tile.y0; ty < tile.y1; ++ty)
          for (int tx = tile.x0; tx < tile.x1; ++tx)
            planes[c].push_back(image.at(static_cast<int>(c), tx, ty));
        pointers.push_back(planes[c].data());
      }
      auto done = (*writer)->write_tile(tile, pointers);
      ASSERT_TRUE(done) << message_of(done);
    }
  auto closed = (*writer)->close();
  ASSERT_TRUE(closed) << message_of(closed);
  auto read = read_image(folder / "a.exr");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->planes[3], image.planes[3]);
}

TEST(Exr, AttributesAndProvenance) {
  Folder folder;
  Image image = numbered({0, 0, 4, 4}, {0, 0, 4, 4}, {{"R", PixelType::float16}});
  image.spec.attributes["pse/program"] = "color = white * Noise(point)\n";
  image.spec.attributes["pse/seed"] = "7";
  image.spec.attributes["channels"] = "must not harm";
  image.spec.frames_per_second = 24000.0 / 1001;
  image.spec.pixel_aspect = 2;
  ASSERT_TRUE(write_image(folder / "a.exr", image));
  auto reader = open_reader(folder / "a.exr");
  ASSERT_TRUE(reader);
  const auto& spec = (*reader)->spec();
  EXPECT_EQ(spec.attributes.at("pse/program"), "color = white * Noise(point)\n");
  EXPECT_EQ(spec.attributes.at("pse/seed"), "7");
  EXPECT_DOUBLE_EQ(spec.frames_per_second, 24000.0 / 1001);
  EXPECT_EQ(spec.pixel_aspect, 2);
  EXPECT_EQ(spec.storage, "zip, scan lines");
}

TEST(Exr, TheRealSequence) {
  PSE_REAL_FILE(path, "singlepart.0001.exr");
  auto image = read_image(path);
  ASSERT_TRUE(image) << message_of(image);
  EXPECT_EQ(image->spec.channels.size(), 20u);
  EXPECT_EQ(image->spec.display, (Window{0, 0, 2048, 1556}));
  EXPECT_EQ(image->spec.data, (Window{654, 245, 1565, 1121}));
  EXPECT_GE(image->spec.find("forward.left.u"), 0);
}

TEST(Exr, TheRealImages) {
  for (const char* name : {"BrightRingsNanInf.exr", "t08.exr", "Cannon.exr", "KernerEnvLatLong.exr",
                           "singlepart.0002.exr", "singlepart.0003.exr"}) {
    PSE_REAL_FILE(path, name);
    Folder folder;
    auto image = read_image(path);
    ASSERT_TRUE(image) << name << ": " << message_of(image);
    ASSERT_TRUE(write_image(folder / "copy.exr", *image));
    auto again = read_image(folder / "copy.exr");
    ASSERT_TRUE(again) << message_of(again);
    expect_same_bits(*image, *again);
  }
}

}  // namespace
}  // namespace pse::image
