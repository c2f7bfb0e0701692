// PNG in and out: exact steps, alpha, data, texts.
#include <cmath>

#include "files.h"

namespace pse::image {
namespace {

using namespace test;

ReadOptions as_stored() {
  ReadOptions options;
  options.working.reset();
  return options;
}

// All 256 steps of sRGB survive decoding to light and encoding again, with and without dithering.
TEST(Png, EveryStepSurvives) {
  Folder folder;
  Image image =
      numbered({0, 0, 256, 2}, {0, 0, 256, 2},
               {{"R", PixelType::uint8}, {"G", PixelType::uint8}, {"B", PixelType::uint8}});
  for (auto& plane : image.planes)
    for (std::size_t i = 0; i < 512; ++i)
      plane[i] = srgb_decode(static_cast<float>(i % 256) / 255.0f);
  for (const bool dithered : {false, true}) {
    WriteOptions options;
    options.dither = dithered;
    ASSERT_TRUE(write_image(folder / "a.png", image, options));
    auto stored = read_image(folder / "a.png", as_stored());
    ASSERT_TRUE(stored) << message_of(stored);
    for (std::size_t i = 0; i < 512; ++i)
      ASSERT_EQ(stored->planes[1][i], static_cast<float>(i % 256) / 255.0f);
    auto light = read_image(folder / "a.png");
    ASSERT_TRUE(light);
    EXPECT_EQ(light->planes[0], image.planes[0]);
  }
}

// Premultiplied 0.25 under alpha 0.5 is stored as straight 0.5, which sRGB writes as 187.5 (188).
TEST(Png, AlphaIsStraightInTheFileAndPremultipliedHere) {
  Folder folder;
  Image image = numbered({0, 0, 1, 1}, {0, 0, 1, 1},
                         {{"R", PixelType::float16},
                          {"G", PixelType::float16},
                          {"B", PixelType::float16},
                          {"A", PixelType::float16}});
  image.planes = {{0.25f}, {0.5f}, {0.0f}, {0.5f}};
  WriteOptions options;
  options.bits = 16;
  ASSERT_TRUE(write_image(folder / "a.png", image, options));
  auto stored = read_image(folder / "a.png", as_stored());
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->spec.channels[0].type, PixelType::uint16);
  EXPECT_NEAR(stored->planes[0][0], 0.735357f, 1e-5f);
  EXPECT_NEAR(stored->planes[1][0], 1.0f, 1e-5f);
  auto light = read_image(folder / "a.png");
  ASSERT_TRUE(light);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(light->planes[c][0], image.planes[c][0], 2e-5f);
}

TEST(Png, DataIsNotTransformed) {
  Folder folder;
  Image image = numbered({0, 0, 2, 1}, {0, 0, 2, 1}, {{"heat.Y", PixelType::float32}});
  image.planes[0] = {0.2f, 0.6f};
  WriteOptions options;
  options.tone = Tone::filmic;
  ASSERT_TRUE(write_image(folder / "a.png", image, options));
  auto light = read_image(folder / "a.png");
  ASSERT_TRUE(light);
  EXPECT_EQ(light->planes[0], (std::vector<float>{51 / 255.0f, 153 / 255.0f}));
}

// Frame 4 x 3, data window reaching out of it on the left and covering columns 0 and 1 of rows 1
// and 2.
TEST(Png, TheFrameIsWhole) {
  Folder folder;
  Image image = numbered({10, 20, 14, 23}, {8, 21, 12, 23}, {{"heat.Y", PixelType::float32}});
  image.planes[0] = {0.2f, 0.2f, 0.4f, 0.6f, 0.2f, 0.2f, 0.8f, 1.0f};
  ASSERT_TRUE(write_image(folder / "a.png", image));
  auto read = read_image(folder / "a.png");
  ASSERT_TRUE(read) << message_of(read);
  EXPECT_EQ(read->spec.data, (Window{0, 0, 4, 3}));
  EXPECT_EQ(read->planes[0], (std::vector<float>{0, 0, 0, 0, 102 / 255.0f, 153 / 255.0f, 0, 0,
                                                 204 / 255.0f, 1, 0, 0}));
}

TEST(Png, ManyOutputsDoNotFit) {
  Folder folder;
  const Image image = numbered({0, 0, 2, 1}, {0, 0, 2, 1},
                               {{"R", PixelType::float16},
                                {"G", PixelType::float16},
                                {"B", PixelType::float16},
                                {"Z", PixelType::float32}});
  auto written = write_image(folder / "a.png", image);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::unsupported);
  EXPECT_EQ(folder.entries(), 0);
}

TEST(Png, TextsOfAnyLength) {
  Folder folder;
  Image image = numbered({0, 0, 2, 1}, {0, 0, 2, 1}, {{"Y", PixelType::float16}});
  image.spec.attributes["pse/program"] = std::string(100'000, 'x') + "\xc3\xa4";
  image.spec.attributes[std::string(100, 'k')] = "too long a name for PNG";
  ASSERT_TRUE(write_image(folder / "a.png", image));
  auto reader = open_reader(folder / "a.png");
  ASSERT_TRUE(reader) << message_of(reader);
  EXPECT_EQ((*reader)->spec().attributes.at("pse/program"), image.spec.attributes["pse/program"]);
  EXPECT_EQ((*reader)->spec().attributes.size(), 1u);
}

TEST(Png, RowsAgainFromTheStart) {
  Folder folder;
  const Image image = numbered({0, 0, 3, 40}, {0, 0, 3, 40}, {{"Y", PixelType::float16}});
  ASSERT_TRUE(write_image(folder / "a.png", image));
  auto whole = read_image(folder / "a.png");
  auto reader = open_reader(folder / "a.png");
  ASSERT_TRUE(whole && reader);
  const std::vector<int> channels = {0};
  for (const int y : {39, 0, 0, 17, 16}) {
    std::vector<float> row(3);
    const std::vector<float*> planes = {row.data()};
    ASSERT_TRUE((*reader)->read_rows(y, y + 1, channels, planes));
    for (int x = 0; x < 3; ++x) EXPECT_EQ(row[static_cast<std::size_t>(x)], whole->at(0, x, y));
  }
}

}  // namespace
}  // namespace pse::image
