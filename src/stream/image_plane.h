// The image plane as a source of samples: the names that it brings and their values at each pixel.
// Pixel (0, 0) is at the top left and samples lie at pixel centres. In the plane, x points right
// and y up, 0 is the middle, and y runs from -1 at the bottom of the picture to 1 at its top; x
// from -aspect to aspect.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stream/executor.h"
#include "stream/sample_source.h"

namespace pse {

// Maps the point [x y 0 1] of the plane to where the program sees it: rows of a 4x4 matrix. (The
// 2002 chapter's XFORM.)
using PlaneTransform = std::array<double, 16>;

// 16 numbers are the matrix row by row; 9 a 3x3 matrix of [x y 1]; 6 its first two rows. Nothing
// for other counts.
std::optional<PlaneTransform> plane_transform(const std::vector<double>& numbers);

struct ImagePlane {
  int width = 512, height = 512;  // of the whole picture, whatever part of it is computed
  double frame = 0;
  double fps = 24;
  std::uint32_t seed = 0;
  double sample_x = 0.5, sample_y = 0.5;  // place of the sample within its pixel
  std::optional<PlaneTransform> transform;
};

// x y u v point px py per sample; frame time fps width height aspect pixelsize pixel_freq seed
// begin_frame per frame. Where a prepass found matter on a pixel's ray, `prepass.near` and
// `prepass.far` (here: everywhere), and while it looks, `prepass.step` (here: 0); see
// app/prepass.h. x y u v point px py have slopes: those of the frame unless the transform is
// projective.
std::vector<StreamName> image_plane_names(const std::optional<PlaneTransform>& transform = {});

// Sets the uniforms of the module's frame-rate inputs that the plane brings; leaves the others
// alone. Makes room in state.uniforms for every input.
void set_plane_uniforms(const ir::Module& module, const ImagePlane& plane, FrameState& state);

// Fills the module's sample-rate inputs that the plane brings, for tiles within `window`; leaves
// the others alone.
TileSource image_plane_source(const ir::Module& module, const ImagePlane& plane,
                              const Rect& window);

// The same inputs at any places of the picture; at pixel centres the same bits.
std::unique_ptr<SampleSource> image_plane_samples(const ir::Module& module,
                                                  const ImagePlane& plane);

// How they change from pixel to pixel.
InputChanges image_plane_changes(const std::optional<PlaneTransform>& transform);

}  // namespace pse
