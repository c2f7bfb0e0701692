// A reader around a reader; see to_working.h.
#include "image/to_working.h"

#include <algorithm>
#include <cmath>

namespace pse::image {
namespace {

// Channels that hold one colour: red, green, blue (or one grey), and the alpha that goes with them.
struct Colour {
  std::vector<int> values;
  int alpha = -1;
};

// Every triple `layer.R layer.G layer.B`, the root's included, and a root Y alone.
std::vector<Colour> colours_of(const ImageSpec& spec) {
  std::vector<Colour> found;
  for (const auto& channel : spec.channels) {
    if (channel.name != "R" && !channel.name.ends_with(".R")) continue;
    const std::string layer = channel.name.substr(0, channel.name.size() - 1);
    const int r = spec.find(layer + "R"), g = spec.find(layer + "G"), b = spec.find(layer + "B");
    if (g >= 0 && b >= 0) found.push_back({{r, g, b}, spec.find(layer + "A")});
  }
  if (spec.find("R") < 0 && spec.find("Y") >= 0)
    found.push_back({{spec.find("Y")}, spec.find("A")});
  return found;
}

class Working : public ImageReader {
 public:
  Working(std::unique_ptr<ImageReader> stored, ColourSpace working)
      : stored_(std::move(stored)), colours_(colours_of(stored_->spec())) {
    const ImageSpec& from = stored_->spec();
    spec_ = from;
    const Chromaticities own =
        from.chromaticities.value_or(chromaticities_of(ColourSpace::lin_rec709));
    const Chromaticities& wanted = chromaticities_of(working);
    matrix_ = colour_matrix(own, wanted);
    adapt_ = false;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        if (!std::isfinite(matrix_[i][j])) matrix_ = colour_matrix(wanted, wanted);
        adapt_ = adapt_ || std::fabs(matrix_[i][j] - (i == j ? 1.0 : 0.0)) > 1e-4;
      }
    spec_.transfer = Transfer::linear;
    spec_.alpha = Alpha::premultiplied;
    spec_.chromaticities = wanted;
    if (working == ColourSpace::lin_rec709) spec_.chromaticities.reset();
  }

  bool needed() const {
    const ImageSpec& from = stored_->spec();
    return adapt_ || from.transfer != Transfer::linear || from.alpha != Alpha::premultiplied;
  }
  std::unique_ptr<ImageReader> release() { return std::move(stored_); }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    // A colour is converted as a whole: read its other channels too.
    const std::size_t count = spec_.channels.size();
    if (channels.size() != planes.size() || y1 < y0)
      return fail(ErrorKind::bad_request, "rows outside the image");
    std::vector<float*> where(count, nullptr);
    for (std::size_t i = 0; i < channels.size(); ++i)
      where.at(static_cast<std::size_t>(channels[i])) = planes[i];
    std::vector<std::vector<float>> extra;
    std::vector<const Colour*> touched;
    const std::size_t size =
        static_cast<std::size_t>(spec_.data.width()) * static_cast<std::size_t>(y1 - y0);
    for (const Colour& colour : colours_) {
      const auto asked = [&](int c) { return where[static_cast<std::size_t>(c)] != nullptr; };
      if (!std::any_of(colour.values.begin(), colour.values.end(), asked)) continue;
      touched.push_back(&colour);
      auto all = colour.values;
      if (colour.alpha >= 0) all.push_back(colour.alpha);
      for (const int c : all) {
        if (asked(c)) continue;
        where[static_cast<std::size_t>(c)] = extra.emplace_back(size).data();
      }
    }
    std::vector<int> list;
    std::vector<float*> targets;
    for (std::size_t c = 0; c < count; ++c) {
      if (where[c] == nullptr) continue;
      list.push_back(static_cast<int>(c));
      targets.push_back(where[c]);
    }
    if (auto done = stored_->read_rows(y0, y1, list, targets); !done) return done;
    for (const Colour* colour : touched) convert(*colour, where, size);
    // A channel that was asked for twice.
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (const float* read = where[static_cast<std::size_t>(channels[i])]; read != planes[i])
        std::copy_n(read, size, planes[i]);
    return {};
  }

 private:
  void convert(const Colour& colour, const std::vector<float*>& where, std::size_t size) const {
    const ImageSpec& from = stored_->spec();
    const auto plane = [&](int c) { return where[static_cast<std::size_t>(c)]; };
    const float* alpha = colour.alpha >= 0 ? plane(colour.alpha) : nullptr;
    for (const int c : colour.values) {
      float* value = plane(c);
      if (from.transfer == Transfer::srgb)
        for (std::size_t i = 0; i < size; ++i) value[i] = srgb_decode(value[i]);
      if (from.transfer == Transfer::power)
        for (std::size_t i = 0; i < size; ++i)
          value[i] = std::pow(std::max(value[i], 0.0f), from.gamma);
      if (alpha != nullptr && from.alpha == Alpha::straight)
        for (std::size_t i = 0; i < size; ++i) value[i] *= alpha[i];
    }
    if (adapt_ && colour.values.size() == 3)
      apply(matrix_, plane(colour.values[0]), plane(colour.values[1]), plane(colour.values[2]),
            static_cast<std::int64_t>(size));
  }

  std::unique_ptr<ImageReader> stored_;
  std::vector<Colour> colours_;
  Matrix3 matrix_{};
  bool adapt_ = false;
};

}  // namespace

std::unique_ptr<ImageReader> to_working(std::unique_ptr<ImageReader> stored, ColourSpace working) {
  auto reader = std::make_unique<Working>(std::move(stored), working);
  if (!reader->needed()) return reader->release();
  return reader;
}

}  // namespace pse::image
