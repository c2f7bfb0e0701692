// Where samples come from when they are wanted at any places of the picture and not only at pixel
// centres: antialiasing runs a program at more samples where a pixel needs them, and does so in the
// same way for the image plane and for surfaces (2002 chapter, "Antialiased rendering of procedural
// textures").
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

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

  // Whether fill() brings this input, the slope per pixel ("NAME$x", "NAME$y") of another one.
  virtual bool brings_slope(const std::string&) const { return false; }
};

// How an input of sample rate changes from pixel to pixel.
enum class Change : std::uint8_t {
  none,  // not at all
  even,  // by the same amount everywhere in the picture
  any,
};
struct Changes {
  Change along_x = Change::any, along_y = Change::any;
};
// What is known of a source before it is made: the changes of an input, by its name.
using InputChanges = std::function<Changes(std::string_view input)>;
inline Changes unknown_changes(std::string_view) { return {}; }

}  // namespace pse
