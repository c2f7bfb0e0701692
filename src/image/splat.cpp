// Spreading rows over pixels. See the header.
#include "image/splat.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pse::image {
namespace {

// The cubic B-spline: 2/3 in the middle, 0 from 2 on.
double spline(double t) {
  const double a = std::fabs(t);
  if (a >= 2) return 0;
  if (a >= 1) return (2 - a) * (2 - a) * (2 - a) / 6;
  return 2.0 / 3 - a * a * (1 - a / 2);
}

// A kernel along one axis, at the pixels from `begin` on; the weights of all pixels, also of those
// outside the picture, add up to 1.
struct Axis {
  int begin = 0;
  std::vector<double> weights;

  void place(double centre, double size) {
    begin = static_cast<int>(std::floor(centre - 2 * size));
    const int end = static_cast<int>(std::ceil(centre + 2 * size));
    weights.clear();
    double sum = 0;
    for (int i = begin; i < end; ++i) {
      weights.push_back(spline((i + 0.5 - centre) / size));
      sum += weights.back();
    }
    for (double& weight : weights) weight /= sum;
  }
};

constexpr double largest_size = 4096;

class Splatter {
 public:
  Splatter(std::span<const SplatColumn> columns, int width, int height)
      : columns_(columns), width_(width), height_(height) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    result_.coverage.resize(pixels);
    result_.planes.resize(columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      result_.planes[c].resize(pixels);
      with_nearest_ = with_nearest_ || columns[c].rule == Rule::nearest;
    }
    if (with_nearest_) nearest_.resize(pixels, std::numeric_limits<double>::infinity());
  }

  void add(std::size_t row, const Place& place) {
    const double size = std::clamp(place.size, 1.0, largest_size);
    if (!(place.x > -2 * size && place.x < width_ + 2 * size && place.y > -2 * size &&
          place.y < height_ + 2 * size))
      return;
    across_.place(place.x, size);
    down_.place(place.y, size);
    const int y0 = std::max(down_.begin, 0);
    const int y1 = std::min(down_.begin + static_cast<int>(down_.weights.size()), height_);
    const int x0 = std::max(across_.begin, 0);
    const int x1 = std::min(across_.begin + static_cast<int>(across_.weights.size()), width_);
    const double middle = spline(0) * spline(0) / (size * size);
    for (int y = y0; y < y1; ++y) {
      const double wy = down_.weights[static_cast<std::size_t>(y - down_.begin)];
      for (int x = x0; x < x1; ++x) {
        const double w = wy * across_.weights[static_cast<std::size_t>(x - across_.begin)];
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                           static_cast<std::size_t>(x);
        if (w <= 0) continue;
        // Half a pixel to either side, so that places a pixel apart leave no hole.
        const bool inner =
            std::fabs(x + 0.5 - place.x) <= size / 2 && std::fabs(y + 0.5 - place.y) <= size / 2;
        const bool in_front = with_nearest_ && inner && place.distance < nearest_[pixel];
        if (in_front) nearest_[pixel] = place.distance;
        put(row, pixel, w, w / middle, in_front);
      }
    }
  }

  Splatted finish() {
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (columns_[c].rule != Rule::mean) continue;
      for (std::size_t i = 0; i < result_.coverage.size(); ++i)
        if (result_.coverage[i] > 0) result_.planes[c][i] /= result_.coverage[i];
    }
    return std::move(result_);
  }

 private:
  void put(std::size_t row, std::size_t pixel, double weight, double share, bool in_front) {
    const bool first = result_.coverage[pixel] == 0;
    result_.coverage[pixel] += static_cast<float>(weight);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      float& value = result_.planes[c][pixel];
      const float here = columns_[c].values[row];
      switch (columns_[c].rule) {
        case Rule::sum:
        case Rule::mean:
          value += static_cast<float>(here * weight);
          break;
        case Rule::max: {
          const auto shared = static_cast<float>(here * std::min(share, 1.0));
          value = first ? shared : std::max(value, shared);
          break;
        }
        case Rule::nearest:
          if (in_front) value = here;
          break;
      }
    }
  }

  std::span<const SplatColumn> columns_;
  int width_, height_;
  bool with_nearest_ = false;
  Axis across_, down_;
  std::vector<double> nearest_;
  Splatted result_;
};

}  // namespace

std::optional<Rule> rule_from_name(std::string_view name) {
  if (name == "sum") return Rule::sum;
  if (name == "max") return Rule::max;
  if (name == "mean") return Rule::mean;
  if (name == "nearest") return Rule::nearest;
  return std::nullopt;
}

Splatted splat(std::span<const Place> places, std::span<const SplatColumn> columns, int width,
               int height) {
  Splatter splatter(columns, width, height);
  for (std::size_t row = 0; row < places.size(); ++row) splatter.add(row, places[row]);
  return splatter.finish();
}

}  // namespace pse::image
