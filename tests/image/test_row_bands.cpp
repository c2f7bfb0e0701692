// Bands of rows: which are decoded, how often, and that they hold what the reader says.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "image/row_bands.h"

namespace pse::image {
namespace {

// Channel c at (x, y) is 100 c + y; nothing at column x. Counts what it is asked for.
class Counting : public ImageReader {
 public:
  explicit Counting(const Window& data, int bad_row = -1000) : bad_(bad_row) {
    spec_.data = spec_.display = data;
    spec_.channels = {{"a"}, {"b"}, {"c"}};
  }
  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    EXPECT_EQ(inside_.fetch_add(1), 0) << "two threads at once";
    rows += y1 - y0;
    for (std::size_t i = 0; i < channels.size(); ++i)
      for (int y = y0; y < y1; ++y)
        std::fill_n(planes[i] + std::int64_t{y - y0} * spec_.data.width(), spec_.data.width(),
                    static_cast<float>(100 * channels[i] + y));
    --inside_;
    if (bad_ >= y0 && bad_ < y1) return fail(ErrorKind::damaged, "broken there");
    return {};
  }
  int rows = 0;

 private:
  int bad_;
  std::atomic<int> inside_ = 0;
};

float value(const std::vector<std::shared_ptr<const RowBands::Band>>& bands, std::size_t plane,
            int y, int width) {
  for (const auto& band : bands)
    if (y >= band->y0 && y < band->y1)
      return band->planes[plane][static_cast<std::size_t>(std::int64_t{y - band->y0} * width)];
  ADD_FAILURE() << "no band holds row " << y;
  return 0;
}

TEST(RowBands, ASmallImageIsOneBandReadOnce) {
  Counting reader({-5, 7, 95, 207});
  RowBands bands(reader, {2, 0});
  EXPECT_EQ(reader.rows, 0);
  for (int y = 7; y < 207; y += 10) {
    const auto some = bands.rows(y, y + 3);
    ASSERT_TRUE(some);
    EXPECT_EQ(value(*some, 0, y, 100), static_cast<float>(200 + y));
    EXPECT_EQ(value(*some, 1, y + 2, 100), static_cast<float>(y + 2));
  }
  EXPECT_EQ(reader.rows, 200);
  EXPECT_TRUE(bands.rows(0, 7)->empty());
  EXPECT_TRUE(bands.rows(207, 300)->empty());
  EXPECT_EQ((*bands.rows(-100, 300)).size(), 1u);
}

// 8192 x 4096 pixels of one channel: 2^25 values, in bands of 128 rows.
TEST(RowBands, ALargeImageIsReadOnceByRowsOfTiles) {
  Counting reader({0, 0, 8192, 4096});
  RowBands bands(reader, {1});
  ASSERT_EQ(bands.band_height(), 128);
  // Tiles of 100 rows, of which two rows of tiles are under way: each band is decoded once.
  for (int y = 0; y < 4096; y += 100)
    for (const int behind : {0, 100, 0, 100}) {
      const auto some = bands.rows(std::max(0, y - behind), std::min(4096, y - behind + 100));
      ASSERT_TRUE(some);
      if (y < behind) continue;
      EXPECT_EQ(value(*some, 0, y - behind, 8192), static_cast<float>(100 + y - behind));
    }
  EXPECT_EQ(reader.rows, 4096);
  EXPECT_EQ(bands.decoded(), 32);
  // The first ones are forgotten by now, so that no more than some bands are ever held.
  ASSERT_TRUE(bands.rows(0, 1));
  EXPECT_EQ(bands.decoded(), 33);
}

TEST(RowBands, TallTilesDoNotPushTheirOwnBandsOut) {
  Counting reader({0, 0, 8192, 4096});
  RowBands bands(reader, {1});
  for (const int y : {0, 1024, 2048, 3072})
    for (int tile = 0; tile < 4; ++tile) EXPECT_EQ(bands.rows(y, y + 1024)->size(), 8u);
  EXPECT_EQ(reader.rows, 4096);
}

TEST(RowBands, ManyThreadsAskAtOnce) {
  Counting reader({0, 0, 8192, 4096});
  RowBands bands(reader, {0, 1});
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int y = t; y < 4000; y += 97) {
        const auto some = bands.rows(y, y + 64);
        ASSERT_TRUE(some);
        EXPECT_EQ(value(*some, 1, y + 63, 8192), static_cast<float>(100 + y + 63));
      }
    });
}

TEST(RowBands, AnErrorIsToldEachTimeAndOnlyThere) {
  Counting reader({0, 0, 8192, 4096}, 3000);
  RowBands bands(reader, {0});
  EXPECT_TRUE(bands.rows(0, 100));
  for (int i = 0; i < 2; ++i) {
    const auto broken = bands.rows(2990, 3010);
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().message, "broken there");
  }
  EXPECT_TRUE(bands.rows(4000, 4096));
  ReadLimits tight;
  tight.max_bytes = 1000;
  RowBands refused(reader, {0}, tight);
  ASSERT_FALSE(refused.rows(0, 1));
  EXPECT_EQ(refused.rows(0, 1).error().kind, ErrorKind::too_large);
}

}  // namespace
}  // namespace pse::image
