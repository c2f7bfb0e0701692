// From a program's channels to what a display format stores: which channels, unpremultiplied,
// through the tone curve and the sRGB curve, cut to whole steps. Used by PNG, by the formats behind
// OpenImageIO and by MP4.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "image/colour.h"
#include "image/error.h"
#include "image/image.h"
#include "image/ocio.h"

namespace pse::image {

// The channels that a display format stores: grey or three colours, and perhaps alpha.
struct DisplayChannels {
  std::vector<int> values;  // one or three
  int alpha = -1;
  bool colour = true;  // false: data, which is stored as it is
  int count() const { return static_cast<int>(values.size()) + (alpha >= 0 ? 1 : 0); }
};

// R G B (A) or Y (A) are colour. Failing those, the channels of a single layer are stored as data.
Result<DisplayChannels> pick_display_channels(const ImageSpec& spec, const std::string& file);

class DisplayTransform {
 public:
  // `ocio` matters to Tone::ocio only. Fails when there is no such view.
  static Result<DisplayTransform> create(DisplayChannels channels, ColourSpace working, Tone tone,
                                         const OcioChoice& ocio);

  const DisplayChannels& channels() const { return channels_; }
  // One row of `width` pixels, interleaved, in display range; values outside [0, 1] are not yet
  // cut. `keep_premultiplied` leaves colour as light over black, for formats without alpha.
  void row(std::span<const float* const> planes, int width, bool keep_premultiplied,
           float* to) const;

 private:
  DisplayTransform() = default;
  void through_view(int width, float* to) const;

  DisplayChannels channels_;
  Tone tone_ = Tone::clip;
  bool adapt_ = false;
  Matrix3 to_display_{};
  std::shared_ptr<const OcioView> view_;
};

// A display value as a whole number of steps. NaN becomes 0.
std::uint8_t to_8_bits(float value, float threshold);
std::uint16_t to_16_bits(float value);

}  // namespace pse::image
