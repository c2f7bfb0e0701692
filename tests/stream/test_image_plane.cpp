// Coordinates of the image plane against values worked out by hand.
#include <gtest/gtest.h>

#include "fake_program.h"
#include "stream/image_plane.h"

namespace pse {
namespace {

const std::vector<std::string> coordinates = {"x",  "y",       "u",       "v",      "px",
                                              "py", "point.0", "point.1", "point.2"};

// The coordinates, in the order above, of one pixel.
std::vector<float> at(const ImagePlane& plane, int column, int row) {
  ir::Module module;
  for (const std::string& name : coordinates) module.inputs.push_back({name});
  std::vector<float> values(coordinates.size(), -99);
  std::vector<float*> planes;
  for (float& value : values) planes.push_back(&value);
  const Rect rect{column, row, column + 1, row + 1};
  image_plane_source(module, plane, {0, 0, plane.width, plane.height})({rect, 1, planes});
  return values;
}

TEST(ImagePlane, CornersOfAWidePicture) {
  // 8x4: aspect 2, a pixel is 1/2 wide in the plane, so the outer centres are 1/4 inside the edges.
  const ImagePlane plane{.width = 8, .height = 4};
  EXPECT_EQ(at(plane, 0, 0),
            (std::vector<float>{-1.75f, 0.75f, 0.0625f, 0.875f, 0.5f, 0.5f, -1.75f, 0.75f, 0}));
  EXPECT_EQ(at(plane, 7, 3),
            (std::vector<float>{1.75f, -0.75f, 0.9375f, 0.125f, 7.5f, 3.5f, 1.75f, -0.75f, 0}));
}

TEST(ImagePlane, TheMiddlePixelOfAnOddPictureIsTheOrigin) {
  const std::vector<float> middle = at({.width = 5, .height = 3}, 2, 1);
  EXPECT_EQ(middle, (std::vector<float>{0, 0, 0.5f, 0.5f, 2.5f, 1.5f, 0, 0, 0}));
}

TEST(ImagePlane, TheSampleMovesWithinItsPixel) {
  const std::vector<float> corner =
      at({.width = 4, .height = 4, .sample_x = 0, .sample_y = 1}, 0, 3);
  EXPECT_EQ(corner, (std::vector<float>{-1, -1, 0, 0, 0, 4, -1, -1, 0}));
}

TEST(ImagePlane, ATransformMovesTheSceneAndNotThePixels) {
  // Scale by 2, then move by (10, 20): the top left centre (-0.5, 0.5) of a 2x2 picture goes to (9,
  // 21).
  ImagePlane plane{.width = 2, .height = 2, .transform = plane_transform({2, 0, 10, 0, 2, 20})};
  EXPECT_EQ(at(plane, 0, 0), (std::vector<float>{9, 21, 0.25f, 0.75f, 0.5f, 0.5f, 9, 21, 0}));
  // A 4x4 matrix that turns y into z lays the plane on the floor.
  plane.transform = plane_transform({1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 5, 0, 0, 0, 1});
  EXPECT_EQ(at(plane, 0, 0),
            (std::vector<float>{-0.5f, 0, 0.25f, 0.75f, 0.5f, 0.5f, -0.5f, 0, 5.5f}));
  // The third row of a 3x3 matrix divides: w = 2 halves the point.
  plane.transform = plane_transform({1, 0, 0, 0, 1, 0, 0, 0, 2});
  EXPECT_EQ(at(plane, 1, 0)[0], 0.25f);
  EXPECT_FALSE(plane_transform({1, 2, 3}));
}

TEST(ImagePlane, SamplesAnywhereAreThePixelsAtTheirCentresAndLieBetweenThemElsewhere) {
  ir::Module module;
  for (const std::string& name : coordinates) module.inputs.push_back({name});
  const ImagePlane plane{
      .width = 7, .height = 5, .transform = plane_transform({2, 1, 10, .1, 2, 20})};
  const std::unique_ptr<SampleSource> source = image_plane_samples(module, plane);
  EXPECT_TRUE(source->anywhere());
  const std::vector<double> x = {3.5, 4.5, 4, -2}, y = {2.5, 2.5, 2.5, 9};
  std::vector<std::vector<float>> values(coordinates.size(), std::vector<float>(x.size(), -99));
  std::vector<float*> planes;
  for (std::vector<float>& value : values) planes.push_back(value.data());
  planes[1] = nullptr;  // not wanted
  source->fill(x, y, planes);
  const std::vector<float> left = at(plane, 3, 2), right = at(plane, 4, 2);
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    if (k == 1) continue;
    EXPECT_EQ(values[k][0], left[k]) << coordinates[k];
    EXPECT_EQ(values[k][1], right[k]) << coordinates[k];
    EXPECT_NEAR(values[k][2], (left[k] + right[k]) / 2, 1e-5) << coordinates[k];
  }
  EXPECT_EQ(values[1], (std::vector<float>{-99, -99, -99, -99}));
  EXPECT_EQ(values[4][3], -2);  // outside of the picture there are places too
  EXPECT_EQ(values[5][3], 9);
}

TEST(ImagePlane, FrameValues) {
  ir::Module module;
  for (const char* name : {"frame", "time", "fps", "width", "height", "aspect", "pixelsize",
                           "pixel_freq", "seed", "begin_frame", "Knob"})
    module.inputs.push_back({name, ir::Rate::frame});
  FrameState state;
  state.uniforms.assign(module.inputs.size(), 7);
  set_plane_uniforms(module, {.width = 200, .height = 100, .frame = 36, .fps = 24, .seed = 5},
                     state);
  // pixel_freq is the Nyquist frequency: half a cycle per pixel of 0.02.
  EXPECT_EQ(state.uniforms, (std::vector<float>{36, 1.5f, 24, 200, 100, 2, 0.02f, 25, 5, 1, 7}));
}

TEST(ImagePlane, EveryNameItListsIsFilled) {
  ir::Module module;
  for (const StreamName& name : image_plane_names())
    for (int c = 0; c < name.components; ++c)
      module.inputs.push_back(
          {name.components == 1 ? name.name : name.name + "." + std::to_string(c), name.rate});
  FrameState state;
  state.uniforms.assign(module.inputs.size(), -99);
  const ImagePlane plane{.width = 4, .height = 4};
  set_plane_uniforms(module, plane, state);
  std::vector<float> values(module.inputs.size(), -99);
  std::vector<float*> planes;
  for (std::size_t i = 0; i < values.size(); ++i)
    planes.push_back(module.inputs[i].rate == ir::Rate::sample ? &values[i] : nullptr);
  image_plane_source(module, plane, {0, 0, 4, 4})({{0, 0, 1, 1}, 1, planes});
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NE(planes[i] ? values[i] : state.uniforms[i], -99) << module.inputs[i].name;
}

}  // namespace
}  // namespace pse
