// Lookup against answers derived by hand.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <thread>

#include "files.h"
#include "image/texture.h"

namespace pse::image {
namespace {

using namespace test;

// A texture of one component from rows, the topmost first.
Texture of_rows(const std::vector<std::vector<float>>& rows) {
  ImageSpec spec;
  spec.display =
      spec.data = {0, 0, static_cast<int>(rows[0].size()), static_cast<int>(rows.size())};
  spec.channels = {{"a", PixelType::float32}};
  Image image(spec);
  image.planes[0].clear();
  for (const auto& row : rows)
    image.planes[0].insert(image.planes[0].end(), row.begin(), row.end());
  const std::vector<int> channels = {0};
  return Texture(image, channels);
}

float at(const Texture& texture, float u, float v, Filter filter, Wrap wrap = Wrap::clamp,
         float size = 0) {
  float value = -1;
  texture.look_up(u, v, size, filter, wrap, &value);
  return value;
}

TEST(Texture, VPointsUp) {
  const Texture t = of_rows({{1, 2}, {3, 4}});
  EXPECT_EQ(at(t, 0.25f, 0.25f, Filter::nearest), 3);
  EXPECT_EQ(at(t, 0.75f, 0.75f, Filter::nearest), 2);
  EXPECT_EQ(at(t, 0.25f, 0.75f, Filter::linear), 1);
  EXPECT_EQ(at(t, 0.5f, 0.5f, Filter::linear), 2.5f);
  EXPECT_EQ(at(t, 0.5f, 0.25f, Filter::linear), 3.5f);
}

// Texels 1 2 3 4 in a row, looked up at the centres of texels -5 to 8.
TEST(Texture, WrapModes) {
  const Texture t = of_rows({{1, 2, 3, 4}});
  const std::vector<std::pair<Wrap, std::vector<float>>> table = {
      {Wrap::repeat, {4, 1, 2, 3, 4, 1, 2, 3, 4, 1, 2, 3, 4, 1}},
      {Wrap::clamp, {1, 1, 1, 1, 1, 1, 2, 3, 4, 4, 4, 4, 4, 4}},
      {Wrap::mirror, {4, 4, 3, 2, 1, 1, 2, 3, 4, 4, 3, 2, 1, 1}},
      {Wrap::black, {0, 0, 0, 0, 0, 1, 2, 3, 4, 0, 0, 0, 0, 0}}};
  for (const auto& [wrap, values] : table)
    for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::mipmap})
      for (int i = -5; i < 9; ++i)
        EXPECT_EQ(at(t, (static_cast<float>(i) + 0.5f) / 4.0f, 0.5f, filter, wrap),
                  values[static_cast<std::size_t>(i + 5)])
            << static_cast<int>(wrap) << " " << static_cast<int>(filter) << " " << i;
}

TEST(Texture, LinearMeetsTheOtherSide) {
  const Texture t = of_rows({{1, 2, 3, 4}});
  EXPECT_EQ(at(t, 0, 0.5f, Filter::linear, Wrap::repeat), 2.5f);
  EXPECT_EQ(at(t, 1, 0.5f, Filter::linear, Wrap::repeat), 2.5f);
  EXPECT_EQ(at(t, 0, 0.5f, Filter::linear, Wrap::mirror), 1);
  EXPECT_EQ(at(t, 0, 0.5f, Filter::linear, Wrap::black), 0.5f);
}

// Catmull-Rom halfway: (-1/16, 9/16, 9/16, -1/16), and exact on straight lines.
TEST(Texture, Cubic) {
  const Texture t = of_rows({{0, 0, 1, 0, 0}});
  EXPECT_EQ(at(t, 0.4f, 0.5f, Filter::cubic), 9.0f / 16);
  EXPECT_NEAR(at(t, 0.2f, 0.5f, Filter::cubic), -1.0f / 16, 1e-6f);
  const Texture line = of_rows({{0, 1, 2, 3, 4, 5, 6, 7}});
  for (float u = 0.2f; u < 0.8f; u += 0.01f)
    EXPECT_NEAR(at(line, u, 0.5f, Filter::cubic), u * 8 - 0.5f, 2e-6f);
}

// A board of 0 and 1: two texels wide it is 1/2 everywhere; between one and two texels the level
// moves linearly.
TEST(Texture, Mipmap) {
  const Texture t = of_rows({{0, 1, 0, 1}, {1, 0, 1, 0}, {0, 1, 0, 1}, {1, 0, 1, 0}});
  const float u = 0.125f, v = 0.875f;
  EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, 0), 0);
  EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, 0.25f), 0);
  EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, 0.375f), 0.25f);
  for (const float size : {0.5f, 1.0f, 2.0f, 1e30f, std::numeric_limits<float>::infinity()})
    EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, size), 0.5f);
  EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, -1), 0);
  EXPECT_EQ(at(t, u, v, Filter::mipmap, Wrap::repeat, std::nanf("")), 0);
}

// Three texels become one: the mean of all three. Five become two: 2.5 texels each.
TEST(Texture, MipmapOfOddSizes) {
  EXPECT_FLOAT_EQ(at(of_rows({{1, 2, 6}}), 0.5f, 0.5f, Filter::mipmap, Wrap::clamp, 1), 3);
  const Texture five = of_rows({{5, 10, 20, 40, 80}});
  EXPECT_FLOAT_EQ(at(five, 0.25f, 0.5f, Filter::mipmap, Wrap::clamp, 0.4f), (5 + 10 + 10) / 2.5f);
  EXPECT_FLOAT_EQ(at(five, 0.5f, 0.5f, Filter::mipmap, Wrap::clamp, 1e9f),
                  (5 + 10 + 20 + 40 + 80) / 5.0f);
}

TEST(Texture, HardCoordinates) {
  const Texture t = of_rows({{1, 2}, {3, 4}});
  const float inf = std::numeric_limits<float>::infinity(), big = std::numeric_limits<float>::max();
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::mipmap})
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror, Wrap::black}) {
      for (const float bad : {inf, -inf, std::nanf("")}) {
        EXPECT_EQ(at(t, bad, 0.5f, filter, wrap), 0);
        EXPECT_EQ(at(t, 0.5f, bad, filter, wrap), 0);
      }
      for (const float far : {big, -big, 1e20f, -1e-30f, 16777217.0f, -0.0f, 1e-45f})
        for (const float size : {0.0f, 1.0f, big}) {
          const float value = at(t, far, far, filter, wrap, size);
          EXPECT_TRUE(value >= 0 && value <= 5) << value;
        }
    }
}

// The frame counts, not the data window.
TEST(Texture, DataWindowInsideTheFrame) {
  Image image = numbered({0, 0, 4, 2}, {1, 1, 3, 4}, {{"a", PixelType::float32}});
  image.planes[0] = {5, 6, 7, 8, 9, 10};
  const std::vector<int> channels = {0};
  const Texture t(image, channels);
  EXPECT_EQ(t.width(), 4);
  EXPECT_EQ(at(t, 0.375f, 0.25f, Filter::nearest), 5);
  EXPECT_EQ(at(t, 0.625f, 0.25f, Filter::nearest), 6);
  EXPECT_EQ(at(t, 0.375f, 0.75f, Filter::nearest), 0);
}

TEST(TextureCall, BatchesOfAnySizeGiveTheSameBits) {
  Folder folder;
  const Image image =
      numbered({0, 0, 13, 9}, {0, 0, 13, 9},
               {{"R", PixelType::float16}, {"G", PixelType::float16}, {"B", PixelType::float16}});
  ASSERT_TRUE(write_image(folder / "t.exr", image));
  TextureCache cache;
  EXPECT_EQ(*cache.components(folder / "t.exr", "color"), 3);
  auto texture = cache.load(folder / "t.exr", "color");
  ASSERT_TRUE(texture) << message_of(texture);
  EXPECT_EQ(*cache.load(folder / "t.exr", "color"), *texture);

  constexpr std::size_t count = 1000;
  std::vector<float> u(count), v(count), w(count);
  for (std::size_t i = 0; i < count; ++i) {
    u[i] = std::sin(static_cast<float>(i)) * 3;
    v[i] = std::cos(static_cast<float>(i * 7)) * 3;
    w[i] = static_cast<float>(i) / 2000;
  }
  for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::mipmap}) {
    TextureCall call{*texture, filter, Wrap::mirror, true};
    const auto run = [&](std::size_t piece) {
      std::vector<std::vector<float>> out(3, std::vector<float>(count));
      for (std::size_t i = 0; i < count; i += piece) {
        const std::vector<const float*> arguments = {u.data() + i, v.data() + i, w.data() + i};
        const std::vector<float*> results = {out[0].data() + i, out[1].data() + i,
                                             out[2].data() + i};
        TextureCall::run(&call, static_cast<std::int64_t>(std::min(piece, count - i)),
                         arguments.data(), results.data());
      }
      return out;
    };
    const auto whole = run(count);
    for (const std::size_t piece : {1, 3, 64}) EXPECT_EQ(run(piece), whole);
  }
}

TEST(TextureCache, WhatIsWrongIsSaid) {
  Folder folder;
  const Image image = numbered({0, 0, 2, 2}, {0, 0, 2, 2}, {{"heat.Y", PixelType::float32}});
  ASSERT_TRUE(write_image(folder / "t.exr", image));
  TextureCache cache;
  EXPECT_EQ(cache.load(folder / "none.exr", "color").error().kind, ErrorKind::not_found);
  const auto missing = cache.load(folder / "t.exr", "color");
  ASSERT_FALSE(missing);
  EXPECT_TRUE(missing.error().message.ends_with("has no layer color; it has heat"));
}

TEST(TextureCache, OneLoadForManyThreads) {
  Folder folder;
  const Image image = numbered({0, 0, 64, 64}, {0, 0, 64, 64}, {{"heat.Y", PixelType::float32}});
  ASSERT_TRUE(write_image(folder / "t.exr", image));
  TextureCache cache;
  std::vector<const Texture*> seen(8);
  {
    std::vector<std::jthread> threads;
    for (auto& place : seen)
      threads.emplace_back([&cache, &folder, &place] {
        const auto texture = cache.load(folder / "t.exr", "heat");
        if (texture) place = texture->get();
        float value = 0;
        if (place != nullptr)
          place->look_up(0.3f, 0.4f, 0.5f, Filter::mipmap, Wrap::repeat, &value);
      });
  }
  for (const Texture* texture : seen) EXPECT_EQ(texture, seen[0]);
  EXPECT_NE(seen[0], nullptr);
}

// ---- Large textures, in tiles on the disk ----

// Noise of all magnitudes, infinity included; the frame reaches beyond the data on one side.
Image scattered(int width, int height) {
  Image image =
      numbered({0, 0, width, height}, {0, 2, width - 3, height},
               {{"R", PixelType::float32}, {"G", PixelType::float32}, {"B", PixelType::float32}});
  std::uint32_t state = 1;
  for (auto& plane : image.planes)
    for (float& value : plane) {
      state = state * 1664525u + 1013904223u;
      value = std::ldexp(static_cast<float>(state >> 8), static_cast<int>(state % 40) - 40);
    }
  image.planes[1][5000] = std::numeric_limits<float>::infinity();
  return image;
}

constexpr TextureMemory all_to_disk{.whole = 0, .tiles = 0, .small = 0};

std::vector<std::uint32_t> looked_up(const Texture& texture, Filter filter, Wrap wrap) {
  std::vector<std::uint32_t> bits;
  std::array<float, 3> value{};
  for (int i = 0; i < 4000; ++i) {
    const auto t = static_cast<float>(i);
    texture.look_up(std::sin(t) * 3, std::cos(t * 7) * 3, t / 3000, filter, wrap, value.data());
    for (const float one : value) bits.push_back(std::bit_cast<std::uint32_t>(one));
  }
  return bits;
}

TEST(LargeTexture, HasTheBitsOfOneInMemory) {
  Folder folder;
  for (const auto& [width, height] : {std::pair(200, 150), std::pair(64, 128), std::pair(65, 3)}) {
    const std::string file = folder / (std::to_string(width) + ".exr");
    Image image = scattered(std::max(width, 100), std::max(height, 60));
    image.spec.display = {0, 0, width, height};
    ASSERT_TRUE(write_image(file, image));
    TextureCache in_memory, on_disk({}, {}, all_to_disk);
    const auto one = in_memory.load(file, "color"), other = on_disk.load(file, "color");
    ASSERT_TRUE(one && other) << message_of(other);
    EXPECT_TRUE((*one)->in_memory());
    EXPECT_FALSE((*other)->in_memory());
    EXPECT_EQ((*other)->width(), width);
    for (const Filter filter : {Filter::nearest, Filter::linear, Filter::cubic, Filter::mipmap}) {
      ASSERT_TRUE((*other)->prepare(filter));
      for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror, Wrap::black})
        EXPECT_EQ(looked_up(**other, filter, wrap), looked_up(**one, filter, wrap))
            << width << " " << static_cast<int>(filter) << " " << static_cast<int>(wrap);
    }
  }
}

TEST(LargeTexture, ManyThreadsSeeTheSame) {
  Folder folder;
  ASSERT_TRUE(write_image(folder / "t.exr", scattered(300, 200)));
  TextureCache cache({}, {}, all_to_disk);
  const auto texture = cache.load(folder / "t.exr", "color");
  ASSERT_TRUE(texture);
  const auto alone = looked_up(**texture, Filter::cubic, Wrap::mirror);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back(
        [&] { EXPECT_EQ(looked_up(**texture, Filter::cubic, Wrap::mirror), alone); });
}

// Textures stay in memory until it is used up; small ones always do.
TEST(LargeTexture, GoesToTheDiskWhereMemoryIsUsedUp) {
  Folder folder;
  for (const char* name : {"a.exr", "b.exr"})
    ASSERT_TRUE(write_image(folder / name, scattered(100, 100)));
  ASSERT_TRUE(write_image(folder / "small.exr", scattered(80, 70)));
  // 100 x 100 x 3 floats and a third more for the smaller sizes are 160,000 bytes.
  TextureCache cache({}, {}, {.whole = 200000, .tiles = 1 << 20, .small = 100000});
  EXPECT_TRUE((*cache.load(folder / "a.exr", "color"))->in_memory());
  EXPECT_FALSE((*cache.load(folder / "b.exr", "color"))->in_memory());
  EXPECT_TRUE((*cache.load(folder / "small.exr", "color"))->in_memory());
}

TEST(TileCache, ForgetsWhatWasUsedLongestAgo) {
  const auto tile = [](float value) {
    return std::make_shared<const std::vector<float>>(256, value);  // 1 KiB
  };
  TileCache cache(16 * 2048);  // two tiles in each of 16 parts
  for (std::uint64_t key : {0, 16, 32}) {
    cache.keep(key, tile(static_cast<float>(key)));
    EXPECT_NE(cache.find(0), nullptr);  // 0 stays in use
  }
  EXPECT_EQ(cache.find(16), nullptr);
  ASSERT_NE(cache.find(32), nullptr);
  EXPECT_EQ(cache.find(32)->front(), 32.0f);
  EXPECT_NE(cache.new_owner(), cache.new_owner());
}

// What is wrong with the file is said when it is loaded, and so is a disk without room.
TEST(LargeTexture, WhatIsWrongIsSaid) {
  Folder folder;
  ASSERT_TRUE(write_image(folder / "t.exr", scattered(300, 200)));
  std::filesystem::resize_file(folder / "t.exr", 200000);
  TextureCache cache({}, {}, all_to_disk);
  EXPECT_FALSE(cache.load(folder / "t.exr", "color"));

  ASSERT_TRUE(write_image(folder / "u.exr", scattered(300, 200)));
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before ? before : "";
  ::setenv("TMPDIR", (folder / "nowhere").c_str(), 1);
  const auto refused = cache.load(folder / "u.exr", "color");
  if (before)
    ::setenv("TMPDIR", kept.c_str(), 1);
  else
    ::unsetenv("TMPDIR");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("TMPDIR names the folder"), std::string::npos);
}

}  // namespace
}  // namespace pse::image
