// Where samples come from when they are wanted at any places of the picture and not only at pixel
// centres: antialiasing runs a program at more samples where a pixel needs them, and does so in the
// same way for the image plane and for surfaces (2002 chapter, "Antialiased rendering of procedural
// textures").
#pragma once

#include <span>

namespace pse {

// Fills sample-rate inputs of the module that the source was made for. Deterministic: a value
// depends only on its place. May be called from several threads at once.
class SampleSource {
 public:
  virtual ~SampleSource() = default;

  // x[i], y[i]: a place in pixels of the whole picture, (0, 0) its top left corner, so that pixel
  // (0, 0) has its centre at (.5, .5). planes[k][i] receives module input k; null where it is not
  // wanted. Inputs that the source does not bring are left alone.
  virtual void fill(std::span<const double> x, std::span<const double> y,
                    std::span<float* const> planes) const = 0;

  // False for stored pixels (input images, another renderer's buffers): they are known at pixel
  // centres only, and fill() answers with the pixel that the place lies in.
  virtual bool anywhere() const = 0;

  // Whether every input changes by the same amount from pixel to pixel, wherever these are.
  virtual bool is_even() const { return false; }
};

}  // namespace pse
