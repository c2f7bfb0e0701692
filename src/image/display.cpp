// The display transform of whole rows; see display.h.
#include "image/display.h"

#include <algorithm>
#include <array>
#include <bit>

namespace pse::image {
namespace {

// srgb_encode on [0, 1] by straight lines between 256 points in each octave from 2^-9 on; below,
// the curve itself is a line. The error stays below 1e-6, a fifteenth of a step of 16 bits, and it
// takes a tenth of the time.
class UnitCurve {
 public:
  UnitCurve() {
    for (std::size_t i = 0; i < points_.size(); ++i)
      points_[i] = srgb_encode(
          std::bit_cast<float>(first_bits + (static_cast<std::uint32_t>(i) << step_bits)));
  }

  // For x in [0, 1]; 0 for NaN.
  float operator()(float x) const {
    if (!(x > 0)) return 0;
    const auto bits = std::bit_cast<std::uint32_t>(x);
    if (bits < first_bits) return 12.92f * x;
    const std::uint32_t offset = bits - first_bits;
    const std::size_t at = std::min<std::size_t>(offset >> step_bits, points_.size() - 2);
    const float between =
        static_cast<float>(offset - (static_cast<std::uint32_t>(at) << step_bits)) * 0x1p-15f;
    return points_[at] + between * (points_[at + 1] - points_[at]);
  }

 private:
  static constexpr std::uint32_t first_bits = 118u << 23;  // 2^-9
  static constexpr std::uint32_t step_bits = 15;           // 256 points an octave
  std::array<float, 9 * 256 + 1> points_;
};

const UnitCurve& unit_curve() {
  static const UnitCurve curve;
  return curve;
}

}  // namespace

Result<DisplayChannels> pick_display_channels(const ImageSpec& spec, const std::string& file) {
  DisplayChannels chosen;
  const int r = spec.find("R"), g = spec.find("G"), b = spec.find("B"), y = spec.find("Y");
  chosen.alpha = spec.find("A");
  if (r >= 0 && g >= 0 && b >= 0) {
    chosen.values = {r, g, b};
  } else if (y >= 0) {
    chosen.values = {y};
  }
  if (!chosen.values.empty()) {
    if (chosen.count() == static_cast<int>(spec.channels.size())) return chosen;
    return fail(ErrorKind::unsupported,
                file + " can hold only colour and alpha; write the other channels to an .exr file");
  }

  // No colour: the channels of one layer, as data.
  const auto layer_of = [](const std::string& name) {
    const auto dot = name.rfind('.');
    return dot == std::string::npos ? std::string() : name.substr(0, dot);
  };
  const std::string layer = layer_of(spec.channels.front().name);
  for (const auto& channel : spec.channels)
    if (layer_of(channel.name) != layer || (layer.empty() && spec.channels.size() > 1))
      return fail(ErrorKind::unsupported,
                  file + " can hold only one output; write several to an .exr file");
  if (spec.channels.size() > 4)
    return fail(ErrorKind::unsupported, file + " can hold at most four channels");
  chosen.colour = false;
  chosen.alpha = spec.channels.size() == 4 ? 3 : -1;
  chosen.values = spec.channels.size() == 1 ? std::vector{0} : std::vector{0, 1, 2};
  if (spec.channels.size() == 2) chosen.values = {0, 1, -1};
  return chosen;
}

Result<DisplayTransform> DisplayTransform::create(DisplayChannels channels, ColourSpace working,
                                                  Tone tone, const OcioChoice& ocio) {
  DisplayTransform made;
  made.channels_ = std::move(channels);
  made.tone_ = made.channels_.colour ? tone : Tone::raw;
  if (made.tone_ == Tone::ocio) {
    auto view = open_ocio_view(working, ocio);
    if (!view) return fail(ErrorKind::cannot_write, view.error().message);
    made.view_ = std::move(*view);
    return made;
  }
  const auto &from = chromaticities_of(working), &to = chromaticities_of(ColourSpace::lin_rec709);
  made.adapt_ = made.tone_ != Tone::raw && from != to && made.channels_.values.size() == 3;
  if (made.adapt_) made.to_display_ = colour_matrix(from, to);
  return made;
}

void DisplayTransform::row(std::span<const float* const> planes, int width, bool keep_premultiplied,
                           float* to) const {
  const std::size_t n = channels_.values.size();
  const std::size_t step = static_cast<std::size_t>(channels_.count());
  const float* alpha =
      channels_.alpha >= 0 ? planes[static_cast<std::size_t>(channels_.alpha)] : nullptr;
  const UnitCurve& encode = unit_curve();
  for (int x = 0; x < width; ++x) {
    float* pixel = to + static_cast<std::size_t>(x) * step;
    for (std::size_t i = 0; i < n; ++i)
      pixel[i] =
          channels_.values[i] < 0 ? 0.0f : planes[static_cast<std::size_t>(channels_.values[i])][x];
    if (alpha != nullptr) {
      const float a = alpha[x];
      if (channels_.colour && !keep_premultiplied && a > 0 && a < 1)
        for (std::size_t i = 0; i < n; ++i) pixel[i] /= a;
      pixel[n] = a;
    }
    if (tone_ == Tone::raw) continue;
    if (view_) continue;
    if (adapt_) apply(to_display_, pixel, pixel + 1, pixel + 2, 1);
    for (std::size_t i = 0; i < n; ++i) {
      const float light = tone_ == Tone::filmic ? filmic(pixel[i]) : pixel[i];
      pixel[i] = encode(std::min(std::max(light, 0.0f), 1.0f));
    }
  }
  if (view_) through_view(width, to);
}

// A row at once, because each call of the view costs more than a pixel does.
void DisplayTransform::through_view(int width, float* to) const {
  const std::size_t n = channels_.values.size();
  const std::size_t step = static_cast<std::size_t>(channels_.count());
  std::vector<float> seen(3 * static_cast<std::size_t>(width));
  for (std::size_t x = 0; x < seen.size() / 3; ++x)
    for (std::size_t c = 0; c < 3; ++c) seen[3 * x + c] = to[x * step + std::min(c, n - 1)];
  view_->apply(seen.data(), width);
  for (std::size_t x = 0; x < seen.size() / 3; ++x)
    std::copy_n(seen.data() + 3 * x, n, to + x * step);
}

std::uint8_t to_8_bits(float value, float threshold) {
  if (!(value > 0)) return 0;
  if (value >= 1) return 255;
  return static_cast<std::uint8_t>(value * 255.0f + threshold);
}

std::uint16_t to_16_bits(float value) {
  if (!(value > 0)) return 0;
  if (value >= 1) return 65535;
  return static_cast<std::uint16_t>(value * 65535.0f + 0.5f);
}

}  // namespace pse::image
