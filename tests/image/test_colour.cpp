// Colour arithmetic against published numbers.
#include "image/colour.h"

#include <cmath>
#include <limits>

#include "files.h"

namespace pse::image {
namespace {

using namespace test;

void expect_matrix(const Matrix3& m, const Matrix3& wanted, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(m[i][j], wanted[i][j], tolerance) << i << " " << j;
}

// IEC 61966-2-1 prints this matrix to four digits.
TEST(Colour, Rec709ToXyz) {
  expect_matrix(rgb_to_xyz(chromaticities_of(ColourSpace::lin_rec709)),
                {{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}},
                1e-4);
}

// S-2014-004 prints the matrix from ACEScg (AP1) to XYZ.
TEST(Colour, AcescgToXyz) {
  expect_matrix(rgb_to_xyz(chromaticities_of(ColourSpace::acescg)),
                {{{0.6624541811, 0.1340042065, 0.1561876870},
                  {0.2722287168, 0.6740817658, 0.0536895174},
                  {-0.0055746495, 0.0040607335, 1.0103391003}}},
                1e-8);
}

// The published conversion from linear Rec. 709 to ACEScg with Bradford adaptation.
TEST(Colour, Rec709ToAcescg) {
  const auto& from = chromaticities_of(ColourSpace::lin_rec709);
  const auto& to = chromaticities_of(ColourSpace::acescg);
  expect_matrix(colour_matrix(from, to),
                {{{0.6130974, 0.3395231, 0.0473795},
                  {0.0701937, 0.9163539, 0.0134524},
                  {0.0206156, 0.1095698, 0.8698147}}},
                2e-5);
  expect_matrix(colour_matrix(to, from) * colour_matrix(from, to),
                {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 1e-12);
  // White stays white.
  float r = 1, g = 1, b = 1;
  apply(colour_matrix(from, to), &r, &g, &b, 1);
  EXPECT_NEAR(r, 1, 1e-6);
  EXPECT_NEAR(g, 1, 1e-6);
  EXPECT_NEAR(b, 1, 1e-6);
}

// The curve by the C library's pow, and back.
TEST(Colour, SrgbCurve) {
  EXPECT_EQ(srgb_encode(0), 0);
  EXPECT_EQ(srgb_encode(1), 1);
  EXPECT_EQ(srgb_decode(1), 1);
  EXPECT_NEAR(srgb_encode(0.18f), 0.46135613f, 1e-6f);
  for (double x = 1e-6; x < 100; x *= 1.1) {
    const double wanted = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    EXPECT_NEAR(srgb_encode(static_cast<float>(x)), wanted, 2e-7 * wanted + 1e-9) << x;
    EXPECT_NEAR(srgb_decode(srgb_encode(static_cast<float>(x))), x, 4e-7 * x) << x;
    EXPECT_EQ(srgb_encode(-static_cast<float>(x)), -srgb_encode(static_cast<float>(x)));
  }
  EXPECT_TRUE(std::isnan(srgb_encode(std::nanf(""))));
  EXPECT_TRUE(std::isinf(srgb_encode(std::numeric_limits<float>::infinity())));
}

TEST(Colour, FilmicKeepsMiddleGreyAndRises) {
  EXPECT_EQ(filmic(0.18f), 0.18f);
  EXPECT_EQ(filmic(0.1f), 0.1f);
  EXPECT_NEAR(filmic(1), 0.18 + 0.82 / std::sqrt(2.0), 1e-6);
  EXPECT_EQ(filmic(std::numeric_limits<float>::infinity()), 1);
  float last = 0;
  for (float x = 0.001f; x < 100; x *= 1.05f) {
    const float y = filmic(x);
    EXPECT_GT(y, last) << x;
    EXPECT_LE(y, 1);
    last = y;
  }
  // The slope meets at middle grey.
  const float h = 1e-3f;
  EXPECT_NEAR((filmic(0.18f + h) - filmic(0.18f)) / h, 1, 1e-3);
}

// Over a block the thresholds are evenly spread, and neighbours are far apart.
TEST(Colour, Dither) {
  double sum = 0;
  std::vector<int> bins(8);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const float d = dither(x, y);
      ASSERT_GT(d, 0);
      ASSERT_LT(d, 1);
      sum += d;
      ++bins[static_cast<std::size_t>(d * 8)];
      EXPECT_GT(std::fabs(d - dither(x + 1, y)), 0.2f);
    }
  EXPECT_NEAR(sum / 4096, 0.5, 0.01);
  for (const int count : bins) EXPECT_NEAR(count, 512, 40);
}

// A dark ramp of a tenth of a step: with dithering its mean survives in 8 bits.
TEST(Colour, DitheringKeepsTheMean) {
  Folder folder;
  Image image = numbered({0, 0, 64, 64}, {0, 0, 64, 64}, {{"Y", PixelType::float16}});
  const float level = 40.3f / 255;
  for (auto& value : image.planes[0]) value = srgb_decode(level);
  ASSERT_TRUE(write_image(folder / "a.png", image));
  ReadOptions options;
  options.working.reset();
  const auto read = read_image(folder / "a.png", options);
  ASSERT_TRUE(read);
  double sum = 0;
  for (const float value : read->planes[0]) sum += value;
  EXPECT_NEAR(sum / 4096 * 255, 40.3, 0.02);
}

// Written in ACEScg with its primaries in the header, read in Rec. 709: red is the matrix's first
// column.
TEST(Colour, PrimariesTravelInTheFile) {
  Folder folder;
  Image image = numbered({0, 0, 1, 1}, {0, 0, 1, 1},
                         {{"R", PixelType::float32},
                          {"G", PixelType::float32},
                          {"B", PixelType::float32},
                          {"N.X", PixelType::float32},
                          {"N.Y", PixelType::float32},
                          {"N.Z", PixelType::float32}});
  image.planes = {{0.5f}, {0}, {0}, {0.5f}, {0}, {0}};
  WriteOptions options;
  options.working = ColourSpace::acescg;
  ASSERT_TRUE(write_image(folder / "a.exr", image, options));
  const auto m = colour_matrix(chromaticities_of(ColourSpace::acescg),
                               chromaticities_of(ColourSpace::lin_rec709));
  const std::vector<std::string> only_green = {"G"};
  const auto green = read_image(folder / "a.exr", {}, only_green);
  ASSERT_TRUE(green);
  EXPECT_NEAR(green->planes[0][0], 0.5 * m[1][0], 1e-6);
  const auto all = read_image(folder / "a.exr");
  ASSERT_TRUE(all);
  EXPECT_NEAR(all->at(all->spec.find("R"), 0, 0), 0.5 * m[0][0], 1e-6);
  EXPECT_EQ(all->at(all->spec.find("N.X"), 0, 0), 0.5f);
  ReadOptions aces;
  aces.working = ColourSpace::acescg;
  const auto same = read_image(folder / "a.exr", aces);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->at(same->spec.find("R"), 0, 0), 0.5f);
}

TEST(Colour, OcioWithoutConfigurationIsSaid) {
  Folder folder;
  ::unsetenv("OCIO");
  const Image image = numbered({0, 0, 1, 1}, {0, 0, 1, 1}, {{"Y", PixelType::float16}});
  WriteOptions options;
  options.tone = Tone::ocio;
  const auto written = write_image(folder / "a.png", image, options);
  ASSERT_FALSE(written);
  EXPECT_TRUE(written.error().is_output());
  EXPECT_EQ(folder.entries(), 0);
}

// A configuration whose only view halves the light.
TEST(Colour, OcioView) {
  Folder folder;
  const std::string config =
      "ocio_profile_version: 1\nroles:\n  scene_linear: lin\n  default: lin\ndisplays:\n  screen:\n"
      "    - !<View> {name: half, colorspace: out}\nactive_displays: [screen]\nactive_views: "
      "[half]\ncolorspaces:\n"
      "  - !<ColorSpace>\n    name: lin\n  - !<ColorSpace>\n    name: out\n"
      "    from_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, "
      "0, 0, 0, 1]}\n";
  put_content(folder / "config.ocio", Content(config.begin(), config.end()));
  ::setenv("OCIO", (folder / "config.ocio").c_str(), 1);
  Image image = numbered({0, 0, 1, 1}, {0, 0, 1, 1}, {{"Y", PixelType::float16}});
  image.planes[0] = {0.8f};
  WriteOptions options;
  options.tone = Tone::ocio;
  const auto written = write_image(folder / "a.png", image, options);
  ::unsetenv("OCIO");
  if (!written && message_of(written).find("libpse_ocio") != std::string::npos)
    GTEST_SKIP() << "without OpenColorIO";
  ASSERT_TRUE(written) << message_of(written);
  ReadOptions stored;
  stored.working.reset();
  const auto read = read_image(folder / "a.png", stored);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->planes[0][0], 102 / 255.0f);
}

}  // namespace
}  // namespace pse::image
