// The joined stretches of the up to four pixels whose middles are around a place.
#include "app/span_places.h"

#include <algorithm>
#include <cmath>

#include "app/failure.h"

namespace pse::app {
namespace {

class SpanPlaces : public SampleSource {
 public:
  SpanPlaces(std::unique_ptr<SampleSource> places, StoredSpans spans)
      : places_(std::move(places)), spans_(std::move(spans)) {}

  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const override {
    places_->fill(x, y, planes);
    if (x.empty()) return;
    const auto join_all = [&](const std::optional<StoredSpans::Bound>& bound, float anywhere,
                              auto&& join) {
      float* to = bound ? planes[bound->input] : nullptr;
      if (to == nullptr) return;
      const Rows rows(spans_, *bound, anywhere, y);
      for (std::size_t i = 0; i < x.size(); ++i) to[i] = rows.joined(x[i], y[i], join);
    };
    join_all(spans_.near, anywhere_near, [](float a, float b) { return std::min(a, b); });
    join_all(spans_.far, anywhere_far, [](float a, float b) { return std::max(a, b); });
  }
  bool anywhere() const override { return places_->anywhere(); }
  bool brings_slope(const std::string& name) const override { return places_->brings_slope(name); }

 private:
  // The pixel whose middle is at or before a place.
  static int pixel_before(double place) { return static_cast<int>(std::floor(place - 0.5)); }

  // The rows of one bound that places at `y` want.
  class Rows {
   public:
    Rows(const StoredSpans& spans, const StoredSpans::Bound& bound, float anywhere,
         std::span<const double> y)
        : spans_(spans), data_(spans.bands->window()), plane_(bound.plane), anywhere_(anywhere) {
      const auto [low, high] = std::ranges::minmax(y);
      const int y0 = std::max(pixel_before(low) + spans.origin_y, data_.y0),
                y1 = std::min(pixel_before(high) + 2 + spans.origin_y, data_.y1);
      if (y0 >= y1) return;
      auto bands = spans.bands->rows(y0, y1);
      if (!bands) throw Failure(Exit::input, bands.error().message);
      bands_ = std::move(*bands);
    }

    template <class Join>
    float joined(double x, double y, const Join& join) const {
      const int column = pixel_before(x), row = pixel_before(y);
      const int right = x - 0.5 > column ? column + 1 : column,
                below = y - 0.5 > row ? row + 1 : row;
      float all = at(column, row);
      if (right != column) all = join(all, at(right, row));
      if (below != row) all = join(all, at(column, below));
      if (right != column && below != row) all = join(all, at(right, below));
      return all;
    }

   private:
    float at(int column, int row) const {
      const int x = column + spans_.origin_x, y = row + spans_.origin_y;
      if (x < data_.x0 || x >= data_.x1) return anywhere_;
      for (const auto& band : bands_)
        if (y >= band->y0 && y < band->y1)
          return band->planes[plane_][static_cast<std::size_t>(
              std::int64_t{y - band->y0} * data_.width() + (x - data_.x0))];
      return anywhere_;
    }

    const StoredSpans& spans_;
    const image::Window& data_;
    const std::size_t plane_;
    const float anywhere_;
    std::vector<std::shared_ptr<const image::RowBands::Band>> bands_;
  };

  const std::unique_ptr<SampleSource> places_;
  const StoredSpans spans_;
};

}  // namespace

std::unique_ptr<SampleSource> with_spans(std::unique_ptr<SampleSource> places, StoredSpans spans) {
  return std::make_unique<SpanPlaces>(std::move(places), std::move(spans));
}

}  // namespace pse::app
