// Kinds of EXR files that pse itself does not write: several parts and views, colour differences at
// half size, mip-maps. The files are small ones of the fuzz corpus, made with the OpenEXR library.
#include "files.h"
#include "image/layers.h"

namespace pse::image {
namespace {

using namespace test;

const std::string corpus = PSE_SOURCE_DIR "/tests/fuzz/corpus/image/";

std::string layer_names(const ImageSpec& spec) {
  std::string text;
  for (const auto& layer : layers_of(spec)) text += layer.name + " ";
  return text;
}

// Parts `rgba.left` (view left: R G B A) and `N.right` (view right: R G B Z), everything 0.5.
TEST(ExrKinds, PartsAndViews) {
  const auto left = read_image(corpus + "parts.exr");
  ASSERT_TRUE(left) << message_of(left);
  EXPECT_EQ(layer_names(left->spec), "color alpha right_N right_N_Z ");
  for (const auto& plane : left->planes)
    for (const float value : plane) ASSERT_EQ(value, 0.5f);
  ReadOptions options;
  options.view = "right";
  const auto right = open_reader(corpus + "parts.exr", options);
  ASSERT_TRUE(right) << message_of(right);
  EXPECT_EQ(layer_names((*right)->spec()), "color Z left_rgba ");
}

// Parts `beauty` (R G B A), `normals` (N.X N.Y N.Z) and `depth` (Z): a channel that says
// its layer keeps it.
TEST(ExrKinds, PartsWhoseChannelsSayTheirLayer) {
  const auto image = read_image(corpus + "named_parts.exr");
  ASSERT_TRUE(image) << message_of(image);
  EXPECT_EQ(layer_names(image->spec), "color alpha Z N ");
  for (const char* name : {"N.X", "N.Y", "N.Z", "Z"}) ASSERT_GE(image->spec.find(name), 0) << name;
  EXPECT_EQ(image->at(image->spec.find("N.Y"), 3, 1), 0.25f);
  EXPECT_EQ(image->at(image->spec.find("Z"), 7, 3), 5.0f);
}

TEST(ExrKinds, ViewsOfTheRealSequence) {
  PSE_REAL_FILE(path, "singlepart.0001.exr");
  ReadOptions options;
  options.view = "left";
  const auto left = open_reader(path, options);
  ASSERT_TRUE(left) << message_of(left);
  const auto& spec = (*left)->spec();
  EXPECT_GE(spec.find("R"), 0);
  EXPECT_GE(spec.find("right.R"), 0);
  EXPECT_LT(spec.find("left.R"), 0);
  options.view = "middle";
  const auto none = open_reader(path, options);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::bad_request);
}

// Y = RY = BY = 0.5: R = B = 1.5 * 0.5, and 0.7152 G = Y - 0.2126 R - 0.0722 B.
TEST(ExrKinds, ColourDifferences) {
  const auto image = read_image(corpus + "luma.exr");
  ASSERT_TRUE(image) << message_of(image);
  EXPECT_EQ(layer_names(image->spec), "color ");
  const float green = (0.5f - (0.2126f + 0.0722f) * 0.75f) / 0.7152f;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_EQ(image->at(image->spec.find("R"), x, y), 0.75f);
      EXPECT_EQ(image->at(image->spec.find("B"), x, y), 0.75f);
      EXPECT_NEAR(image->at(image->spec.find("G"), x, y), green, 1e-4f);
    }
  const std::vector<std::string> only = {"B"};
  const auto blue = read_image(corpus + "luma.exr", {}, only);
  ASSERT_TRUE(blue);
  EXPECT_EQ(blue->planes[0][63], 0.75f);
}

TEST(ExrKinds, MipMapsGiveTheFullSize) {
  const auto image = read_image(corpus + "mip.exr");
  ASSERT_TRUE(image) << message_of(image);
  EXPECT_EQ(image->spec.data, (Window{0, 0, 8, 8}));
  EXPECT_EQ(image->spec.storage, "zip, tiles of 4 x 4, mip-map");
  EXPECT_EQ(image->planes[0], std::vector<float>(64, 0.5f));
}

}  // namespace
}  // namespace pse::image
