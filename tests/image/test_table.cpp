// Tables as images: CSV and PLY in, CSV out, what is wrong with its line, and rows spread over
// pixels.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "files.h"
#include "image/layers.h"
#include "image/splat.h"

namespace pse::image {
namespace {

using namespace test;

Result<Image> read_text(const std::string& name, const std::string& text) {
  auto reader = open_reader(bytes_from_memory(name, Content(text.begin(), text.end())));
  if (!reader) return std::unexpected(reader.error());
  return read_image(**reader, {});
}

std::string refusal_of(const std::string& text) {
  const auto image = read_text("t.csv", text);
  return image ? "no error" : image.error().message;
}

TEST(Csv, ColumnsBecomeLayers) {
  const auto image = read_text("t.csv",
                               "# made by hand\n\"x\", y ,light.r,light.g,light.b,z\r\n"
                               "1,2,.5,1e-3,-0.25,+7\r\n\n3,4,5,6,7,8");
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->spec.data, (Window{0, 0, 2, 1}));
  std::string names;
  for (const Layer& layer : layers_of(image->spec))
    names += layer.name + std::to_string(layer.components()) + " ";
  EXPECT_EQ(names, "x1 y1 z1 light3 ");
  EXPECT_EQ(image->at(image->spec.find("light.b"), 0, 0), -0.25f);
  EXPECT_EQ(image->at(image->spec.find("z"), 0, 0), 7.0f);
  EXPECT_EQ(image->at(image->spec.find("light.g"), 0, 0), 1e-3f);
  EXPECT_EQ(image->at(image->spec.find("y"), 1, 0), 4.0f);
}

TEST(Csv, OtherDividers) {
  for (const char* text : {"a;b\n1;2\n", "a\tb\n1\t2\n",
                           "\xef\xbb\xbf"
                           "a,b\n1,2\n"}) {
    const auto image = read_text("t.csv", text);
    ASSERT_TRUE(image) << text << image.error().message;
    EXPECT_EQ(image->at(image->spec.find("b"), 0, 0), 2.0f) << text;
  }
}

TEST(Csv, LongFilesAreReadInBlocks) {
  std::string text = "row,twice\n";
  for (int i = 0; i < 200'000; ++i) text += std::to_string(i) + "," + std::to_string(2 * i) + "\n";
  ASSERT_GT(text.size(), std::size_t{2} << 20);
  const auto image = read_text("t.csv", text);
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->spec.data.width(), 200'000);
  for (const int i : {0, 100'000, 131'072, 199'999}) {
    EXPECT_EQ(image->at(0, i, 0), static_cast<float>(i));
    EXPECT_EQ(image->at(1, i, 0), static_cast<float>(2 * i));
  }
}

TEST(Csv, ErrorsNameTheLine) {
  EXPECT_EQ(refusal_of("a,b\n1,2\n\n3\n"),
            "t.csv:4: the row has fewer numbers than the 2 columns that the first line names");
  EXPECT_EQ(refusal_of("a,b\n1,2,3\n"),
            "t.csv:2: the row has more numbers than the 2 columns that the first line names");
  EXPECT_EQ(refusal_of("a,b\n1,two\n"), "t.csv:2: `two` in column `b` is no number");
  EXPECT_EQ(refusal_of("a,b\n1,2x\n"), "t.csv:2: `2x` in column `b` is no number");
  EXPECT_EQ(refusal_of("a,b\n1,\n"), "t.csv:2: column `b` is empty");
  for (const char* word : {"nan", "-inf", "1e99"})
    EXPECT_NE(refusal_of(std::string("a\n") + word + "\n").find("t.csv:2: `"), std::string::npos);
  EXPECT_EQ(refusal_of("1,2\n3,4\n"),
            "t.csv:1: the first line of a table names its columns, `1` is a number");
  EXPECT_EQ(refusal_of("a,a\n1,2\n"), "t.csv:1: two columns are called `a`");
  EXPECT_EQ(refusal_of("a,b\n"), "t.csv names its columns and has no rows");
  EXPECT_EQ(refusal_of("# nothing\n"), "t.csv is empty");
  EXPECT_EQ(refusal_of("a,b\n1,\x01\x02\n"), "t.csv:2: `??` in column `b` is no number");
}

TEST(Csv, WhatIsWrittenIsReadAgain) {
  const Folder folder;
  ImageSpec spec;
  spec.display = spec.data = {0, 0, 3, 1};
  for (const char* name : {"R", "G", "B", "A", "Z", "heat.Y", "N.X", "N.Y", "N.Z"})
    spec.channels.push_back({name, PixelType::float32});
  Image image(spec);
  for (std::size_t c = 0; c < image.planes.size(); ++c)
    for (std::size_t i = 0; i < 3; ++i)
      image.planes[c][i] = 0.1f * static_cast<float>(c) + 1e-7f * static_cast<float>(i);
  ASSERT_TRUE(write_image(folder / "a.csv", image));
  const Content content = content_of(folder / "a.csv");
  const std::string text(content.begin(), content.end());
  EXPECT_TRUE(text.starts_with("color.r,color.g,color.b,alpha,Z,heat,N.x,N.y,N.z\n")) << text;
  const auto again = read_image(folder / "a.csv");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->planes, image.planes);
}

// A PLY header of two points with a position, a byte of colour and a normal.
std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment hand made\nelement vertex 2\nproperty float x\nproperty double y\n"
         "property short z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property float nx\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
}

template <typename T>
void put(std::string& to, T value, bool swap) {
  std::string raw(sizeof value, '\0');
  std::memcpy(raw.data(), &value, sizeof value);
  if (swap) std::ranges::reverse(raw);
  to += raw;
}

TEST(Ply, AsciiAndBothOrdersOfBytes) {
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::string text = ply_header(format);
    if (format == "ascii") {
      text += "1.5 2.5 -3 255 0 188 0.25\n4 5 6 0 0 0 1\n";
    } else {
      const bool swap = format == "binary_big_endian";
      for (const auto& [x, y, z, b, n] :
           {std::tuple{1.5f, 2.5, short{-3}, 188, 0.25f}, {4.0f, 5.0, short{6}, 0, 1.0f}}) {
        put(text, x, swap), put(text, y, swap), put(text, z, swap);
        text += b > 0 ? "\xff" : std::string(1, '\0');
        text += '\0';
        text += static_cast<char>(b);
        put(text, n, swap);
      }
    }
    const auto image = read_text("points", text);
    ASSERT_TRUE(image) << format << ": " << image.error().message;
    const auto at = [&](const char* name, int row) {
      return image->at(image->spec.find(name), row, 0);
    };
    EXPECT_EQ(at("x", 0), 1.5f);
    EXPECT_EQ(at("y", 1), 5.0f);
    EXPECT_EQ(at("z", 0), -3.0f);
    EXPECT_EQ(at("color.r", 0), 1.0f);
    EXPECT_NEAR(at("color.b", 0), 0.5029, 1e-4);  // sRGB 188
    EXPECT_EQ(at("normal.x", 0), 0.25f);
  }
}

TEST(Ply, WhatIsWrongIsSaid) {
  const auto message = [](const std::string& text) {
    const auto image = read_text("p.ply", text);
    return image ? "no error" : image.error().message;
  };
  EXPECT_EQ(message(ply_header("ascii") + "1 2 3 4 5 6 7\n"),
            "p.ply: point 2 of 2 is missing or is no number");
  EXPECT_EQ(message(ply_header("ascii") + "1 2 3 4 5 6 7\n1 nan 3 4 5 6 7\n"),
            "p.ply: point 2 has a `y` that is NaN or infinite");
  EXPECT_EQ(message("ply\nformat ascii 1.0\nelement vertex 3\n"),
            "p.ply: the header of the PLY file has no end");
  EXPECT_EQ(message("ply\nformat ascii 1.0\nelement vertex 900000000000\nproperty float x\n"
                    "end_header\n1\n"),
            "p.ply has too many points");
}

// One row in a picture of 16 x 12.
Splatted one(Place place, float value, Rule rule) {
  const std::vector<Place> places = {place};
  const std::vector<float> values = {value};
  const std::vector<SplatColumn> columns = {{values, rule}};
  return splat(places, columns, 16, 12);
}

double total(const std::vector<float>& plane) {
  double sum = 0;
  for (const float value : plane) sum += value;
  return sum;
}

TEST(Splat, SumIsKeptWhereverARowFalls) {
  for (double x = 5; x < 6; x += 0.17)
    for (const double size : {0.3, 1.0, 1.7})
      EXPECT_NEAR(total(one({x, 6.3, 0, size}, 3, Rule::sum).planes[0]), 3, 1e-5) << x;
}

TEST(Splat, TheKernelIsTheCubicSpline) {
  // At a pixel's centre: 2/3 there and 1/6 on either side, along both axes.
  const auto made = one({5.5, 6.5}, 36, Rule::sum);
  EXPECT_NEAR(made.planes[0][6 * 16 + 5], 16, 1e-4);
  EXPECT_NEAR(made.planes[0][6 * 16 + 6], 4, 1e-4);
  EXPECT_NEAR(made.planes[0][7 * 16 + 6], 1, 1e-4);
  EXPECT_EQ(made.planes[0][6 * 16 + 7], 0);
  EXPECT_NEAR(made.coverage[6 * 16 + 5], 16.0 / 36, 1e-6);
}

TEST(Splat, RowsAtTheEdgeLoseWhatLiesOutside) {
  EXPECT_NEAR(total(one({0, 6}, 1, Rule::sum).planes[0]), 0.5, 1e-6);
  EXPECT_EQ(total(one({-50, 6}, 1, Rule::sum).planes[0]), 0);
  EXPECT_EQ(total(one({NAN, 6}, 1, Rule::sum).planes[0]), 0);
}

TEST(Splat, Rules) {
  const std::vector<Place> places = {{5.5, 5.5, 2}, {5.5, 5.5, 1}, {6.5, 5.5, 9}};
  const std::vector<float> values = {6, -4, 3};
  const auto made = [&](Rule rule) {
    const std::vector<SplatColumn> columns = {{values, rule}};
    return splat(places, columns, 16, 12).planes[0];
  };
  const std::size_t here = 5 * 16 + 5, right = here + 1, far = 5 * 16 + 10;
  EXPECT_NEAR(made(Rule::max)[here], 6, 1e-5);
  // The third row is a kernel's quarter away: (4 * 2 + 3 * 1/4 ...) stays a mean of what is there.
  EXPECT_NEAR(made(Rule::mean)[here], (4.0 * 6 - 4.0 * 4 + 1.0 * 3) / 9, 1e-5);
  EXPECT_EQ(made(Rule::nearest)[here], -4);
  EXPECT_EQ(made(Rule::nearest)[right], 3);
  for (const Rule rule : {Rule::sum, Rule::max, Rule::mean, Rule::nearest})
    EXPECT_EQ(made(rule)[far], 0);
}

TEST(Splat, OnAGridOfPixelsNothingIsMissing) {
  // A row for every pixel, shifted by any part of one: nearest covers all, sum is even.
  std::vector<Place> places;
  for (int y = -3; y < 15; ++y)
    for (int x = -3; x < 19; ++x) places.push_back({x + 0.87, y + 0.21, 0});
  const std::vector<float> values(places.size(), 1.0f);
  const std::vector<SplatColumn> columns = {{values, Rule::sum}, {values, Rule::nearest}};
  const Splatted made = splat(places, columns, 16, 12);
  for (const float value : made.planes[0]) EXPECT_NEAR(value, 1, 1e-5);
  for (const float value : made.planes[1]) EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace pse::image
