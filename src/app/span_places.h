// What a prepass has found, at any places of the picture: between pixels it is what the pixels
// around have together, and outside of the picture matter may be anywhere. So antialiasing looks
// between pixels with a prepass as without one (app/prepass.h, stream/sample_source.h).
#pragma once

#include <memory>
#include <optional>

#include "image/row_bands.h"
#include "stream/sample_source.h"

namespace pse::app {

// Where no pixel tells: all of the ray.
inline constexpr float anywhere_near = -1e30f, anywhere_far = 1e30f;

// The image of a prepass, and where its numbers go.
struct StoredSpans {
  std::shared_ptr<image::RowBands> bands;
  int origin_x = 0, origin_y = 0;  // of the picture, in the image's coordinates
  struct Bound {
    std::size_t input;  // of the module
    std::size_t plane;  // of the bands
  };
  std::optional<Bound> near = {}, far = {};
};

// `places` with the inputs prepass.near and prepass.far from `spans`. fill() throws Failure (input)
// where the image cannot be read.
std::unique_ptr<SampleSource> with_spans(std::unique_ptr<SampleSource> places, StoredSpans spans);

}  // namespace pse::app
