// Decoding bands and forgetting them; see row_bands.h.
#include "image/row_bands.h"

#include <algorithm>
#include <new>

namespace pse::image {
namespace {

// An image of up to so many values is one band.
constexpr std::int64_t kept_values = std::int64_t{1} << 24;
// Of a larger one a band has about so many pixels: decoding it takes some milliseconds.
constexpr std::int64_t band_pixels = std::int64_t{1} << 20;

int height_of_bands(const Window& window, std::size_t channels) {
  const std::int64_t values = window.pixels() * static_cast<std::int64_t>(channels);
  if (values <= kept_values) return std::max(1, window.height());
  return static_cast<int>(
      std::clamp<std::int64_t>(band_pixels / window.width(), 1, window.height()));
}

}  // namespace

RowBands::RowBands(ImageReader& reader, std::vector<int> channels, const ReadLimits& limits)
    : reader_(reader),
      channels_(std::move(channels)),
      limits_(limits),
      window_(reader.spec().data),
      height_(height_of_bands(window_, channels_.size())) {}

Result<std::vector<std::shared_ptr<const RowBands::Band>>> RowBands::rows(int y0, int y1) {
  std::vector<std::shared_ptr<const Band>> found;
  y0 = std::max(y0, window_.y0), y1 = std::min(y1, window_.y1);
  if (y0 >= y1) return found;
  const int first = (y0 - window_.y0) / height_, last = (y1 - 1 - window_.y0) / height_;
  const std::lock_guard lock(mutex_);
  // Two rows of tiles, each perhaps across one band more.
  most_held_ = std::max(most_held_, 2 * static_cast<std::size_t>(last - first + 2));
  for (int number = first; number <= last; ++number) {
    auto one = band(number);
    if (!one) return std::unexpected(one.error());
    found.push_back(std::move(*one));
  }
  return found;
}

Result<std::shared_ptr<const RowBands::Band>> RowBands::band(int number) {
  const auto held = std::ranges::find(held_, number, [](const auto& entry) { return entry.first; });
  if (held != held_.end()) {
    held_.splice(held_.begin(), held_, held);
    return held_.front().second;
  }
  while (held_.size() >= most_held_) held_.pop_back();
  auto made = decode(number);
  if (made) held_.emplace_front(number, *made);
  return made;
}

Result<std::shared_ptr<const RowBands::Band>> RowBands::decode(int number) {
  auto band = std::make_shared<Band>();
  band->y0 = window_.y0 + number * height_;
  band->y1 = std::min(band->y0 + height_, window_.y1);
  const double bytes = double(window_.width()) * (band->y1 - band->y0) *
                       static_cast<double>(channels_.size() * sizeof(float));
  if (bytes > double(std::min(limits_.max_bytes, limits_.max_band_bytes)))
    return fail(ErrorKind::too_large, "the image takes more memory than the limit of " +
                                          std::to_string(limits_.max_bytes) + " bytes");
  try {
    std::vector<float*> planes;
    const std::size_t size = static_cast<std::size_t>(window_.width()) *
                             static_cast<std::size_t>(band->y1 - band->y0);
    for (std::size_t c = 0; c < channels_.size(); ++c)
      planes.push_back(band->planes.emplace_back(size).data());
    if (auto done = reader_.read_rows(band->y0, band->y1, channels_, planes); !done)
      return std::unexpected(done.error());
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory for the image");
  }
  ++decoded_;
  return band;
}

}  // namespace pse::image
