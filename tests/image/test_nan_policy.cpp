// NaN and infinity on their way into a file.
#include <cmath>
#include <limits>

#include "files.h"
#include "image/compare.h"
#include "image/nan_policy.h"

namespace pse::image {
namespace {

using namespace test;

const float inf = std::numeric_limits<float>::infinity();
const float nan_value = std::nanf("");

// 3 x 3: a NaN in the middle, an infinity in the corner.
Image broken() {
  Image image = numbered({0, 0, 3, 3}, {10, 20, 13, 23}, {{"heat.Y", PixelType::float32}});
  image.planes[0] = {1, 2, 3, 4, nan_value, 6, 7, 8, inf};
  return image;
}

TEST(NanPolicy, CountsAndPlaces) {
  Image image = broken();
  const auto report = apply_nan_policy(image, NanPolicy::keep);
  ASSERT_TRUE(report);
  EXPECT_EQ(describe(*report, image.spec),
            "1 NaN and 1 infinite values in heat.Y, the first at pixel (11, 21)");
  EXPECT_TRUE(std::isnan(image.planes[0][4]));
}

TEST(NanPolicy, Black) {
  Image image = broken();
  ASSERT_TRUE(apply_nan_policy(image, NanPolicy::black));
  EXPECT_EQ(image.planes[0], (std::vector<float>{1, 2, 3, 4, 0, 6, 7, 8, 0}));
}

// The middle: (1+2+3+4+6+7+8) / 7. The corner: (6+8) / 2, without the repaired middle.
TEST(NanPolicy, Box3) {
  Image image = broken();
  ASSERT_TRUE(apply_nan_policy(image, NanPolicy::box3));
  EXPECT_EQ(image.planes[0], (std::vector<float>{1, 2, 3, 4, 31 / 7.0f, 6, 7, 8, 7}));
  Image lonely = numbered({0, 0, 1, 1}, {0, 0, 1, 1}, {{"a", PixelType::float32}});
  lonely.planes[0] = {nan_value};
  ASSERT_TRUE(apply_nan_policy(lonely, NanPolicy::box3));
  EXPECT_EQ(lonely.planes[0][0], 0);
}

TEST(NanPolicy, ErrorNamesTheChannel) {
  Image image = broken();
  const auto report = apply_nan_policy(image, NanPolicy::error);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::not_finite);
  EXPECT_NE(report.error().message.find("heat.Y"), std::string::npos);
  EXPECT_TRUE(report.error().is_output());
}

TEST(NanPolicy, InfiniteDepthIsNoFault) {
  Image image = numbered({0, 0, 2, 1}, {0, 0, 2, 1}, {{"Z", PixelType::float32}});
  image.planes[0] = {inf, 1};
  const auto report = apply_nan_policy(image, NanPolicy::error);
  ASSERT_TRUE(report);
  EXPECT_EQ(image.planes[0][0], inf);
  image.planes[0] = {-inf, 1};
  EXPECT_FALSE(apply_nan_policy(image, NanPolicy::error));
}

// The streaming form gives the same file, whatever the height of the pieces.
TEST(NanPolicy, StreamingIsTheSame) {
  Folder folder;
  for (const auto policy : {NanPolicy::keep, NanPolicy::black, NanPolicy::box3}) {
    Image image = numbered({0, 0, 5, 9}, {0, 0, 5, 9},
                           {{"a", PixelType::float32}, {"b", PixelType::float32}});
    for (const int at : {0, 7, 12, 44}) image.planes[1][static_cast<std::size_t>(at)] = nan_value;
    for (const int piece : {1, 2, 9}) {
      auto writer = open_writer(folder / "a.exr", image.spec);
      ASSERT_TRUE(writer);
      auto report = std::make_shared<NanReport>();
      auto repairing = with_nan_policy(std::move(*writer), policy, report);
      for (int y = 0; y < 9; y += piece) {
        const std::vector<const float*> planes = {image.planes[0].data() + 5 * y,
                                                  image.planes[1].data() + 5 * y};
        ASSERT_TRUE(repairing->write_rows(std::min(piece, 9 - y), planes));
      }
      ASSERT_TRUE(repairing->close());
      EXPECT_EQ((*report)[1].nan, 4);
      Image expected = image;
      ASSERT_TRUE(apply_nan_policy(expected, policy));
      ASSERT_TRUE(write_image(folder / "b.exr", expected));
      EXPECT_EQ(content_of(folder / "a.exr"), content_of(folder / "b.exr"));
    }
  }
}

TEST(NanPolicy, TheRealImage) {
  PSE_REAL_FILE(path, "BrightRingsNanInf.exr");
  auto image = read_image(path);
  ASSERT_TRUE(image) << message_of(image);
  const auto report = apply_nan_policy(*image, NanPolicy::box3);
  ASSERT_TRUE(report);
  std::int64_t nan = 0, infinite = 0;
  for (const auto& found : *report) nan += found.nan, infinite += found.infinite;
  EXPECT_GT(nan, 0);
  EXPECT_GT(infinite, 0);
  for (const auto& plane : image->planes)
    for (const float value : plane) ASSERT_TRUE(std::isfinite(value));
}

// b differs from a by 0.25 in one place of one channel, and has a window one column wider.
TEST(Compare, FindsTheDifference) {
  Folder folder;
  Image a =
      numbered({0, 0, 4, 3}, {0, 0, 4, 3}, {{"A", PixelType::float32}, {"B", PixelType::float32}});
  Image b =
      numbered({0, 0, 4, 3}, {-1, 0, 4, 3}, {{"A", PixelType::float32}, {"C", PixelType::float32}});
  for (int y = 0; y < 3; ++y)
    for (int x = -1; x < 4; ++x) b.pixel(0, x, y) = a.at(0, x, y);
  b.pixel(0, 2, 1) += 0.25f;
  b.pixel(0, 3, 2) = a.pixel(0, 3, 2) = nan_value;
  ASSERT_TRUE(write_image(folder / "a.exr", a));
  ASSERT_TRUE(write_image(folder / "b.exr", b));
  auto ra = open_reader(folder / "a.exr"), rb = open_reader(folder / "b.exr");
  ASSERT_TRUE(ra && rb);
  const auto found = compare(**ra, **rb, 0.1);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->same());
  EXPECT_EQ(found->shape, (std::vector<std::string>{"only the second has the channel C",
                                                    "only the first has the channel B"}));
  ASSERT_EQ(found->channels.size(), 1u);
  EXPECT_EQ(found->channels[0].largest, 0.25);
  EXPECT_EQ(found->channels[0].x, 2);
  EXPECT_EQ(found->channels[0].y, 1);
  EXPECT_EQ(found->channels[0].above, 1);
  EXPECT_NEAR(found->channels[0].rms, std::sqrt(0.0625 / 15), 1e-12);
  auto again = open_reader(folder / "a.exr");
  const auto same = compare(**ra, **again, 0);
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->same());
}

}  // namespace
}  // namespace pse::image
