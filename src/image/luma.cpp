// A reader around a reader; see luma.h. RY = (R - Y) / Y and BY = (B - Y) / Y, where Y is the
// luminance that the file's primaries give R G B.
#include "image/luma.h"

#include <algorithm>
#include <cmath>

namespace pse::image {
namespace {

class LumaReader : public ImageReader {
 public:
  explicit LumaReader(std::unique_ptr<ImageReader> stored) : stored_(std::move(stored)) {
    spec_ = stored_->spec();
    const Matrix3 xyz =
        rgb_to_xyz(spec_.chromaticities.value_or(chromaticities_of(ColourSpace::lin_rec709)));
    weights_ = {xyz[1][0], xyz[1][1], xyz[1][2]};
    for (const double weight : weights_)
      if (!(std::fabs(weight) > 1e-6)) weights_ = {0.2126, 0.7152, 0.0722};

    // Y, RY and BY keep their places in the list under the names of what they become.
    const char* from[3] = {"RY", "Y", "BY"};
    const char* to[3] = {"R", "G", "B"};
    for (std::size_t i = 0; i < 3; ++i) {
      places_[i] = spec_.find(from[i]);
      spec_.channels[static_cast<std::size_t>(places_[i])].name = to[i];
    }
  }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    if (auto done = stored_->read_rows(y0, y1, channels, planes); !done) return done;
    const auto is_colour = [&](int c) {
      return std::find(places_.begin(), places_.end(), c) != places_.end();
    };
    if (std::none_of(channels.begin(), channels.end(), is_colour)) return {};

    // Any of the three needs all of them.
    const auto size =
        static_cast<std::size_t>(spec_.data.width()) * static_cast<std::size_t>(y1 - y0);
    std::vector<float> ry(size), luma(size), by(size);
    const std::vector<float*> rows = {ry.data(), luma.data(), by.data()};
    if (auto done = stored_->read_rows(y0, y1, places_, rows); !done) return done;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      if (!is_colour(channels[i])) continue;
      for (std::size_t p = 0; p < size; ++p) {
        const double y = luma[p], r = (ry[p] + 1.0) * y, b = (by[p] + 1.0) * y;
        double value = (y - weights_[0] * r - weights_[2] * b) / weights_[1];
        if (channels[i] == places_[0]) value = r;
        if (channels[i] == places_[2]) value = b;
        planes[i][p] = static_cast<float>(value);
      }
    }
    return {};
  }

 private:
  std::unique_ptr<ImageReader> stored_;
  std::array<int, 3> places_{};      // of RY, Y, BY
  std::array<double, 3> weights_{};  // of R, G, B in Y
};

}  // namespace

std::unique_ptr<ImageReader> luma_to_rgb(std::unique_ptr<ImageReader> stored) {
  const ImageSpec& spec = stored->spec();
  for (const char* name : {"Y", "RY", "BY"})
    if (spec.find(name) < 0) return stored;
  for (const char* name : {"R", "G", "B"})
    if (spec.find(name) >= 0) return stored;
  return std::make_unique<LumaReader>(std::move(stored));
}

}  // namespace pse::image
