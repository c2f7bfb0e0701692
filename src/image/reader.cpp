// Opening an image by its first bytes, and reading whole images; see reader.h.
#include "image/reader.h"

#include <algorithm>
#include <future>
#include <numeric>

#include "image/exr_header.h"
#include "image/exr_reader.h"
#include "image/foreign.h"
#include "image/luma.h"
#include "image/png_reader.h"
#include "image/table.h"
#include "image/to_working.h"

namespace pse::image {
namespace {

Result<std::unique_ptr<ImageReader>> open_stored(const Bytes& bytes, const ReadOptions& options) {
  if (bytes->size() == 0) return fail(ErrorKind::truncated, bytes->name() + " is empty");
  if (is_exr(*bytes)) return open_exr(bytes, options);
  if (is_png(*bytes)) return open_png(bytes, options);
  if (is_ply(*bytes) || is_csv(*bytes)) return open_table(bytes, options);
  if (is_almost_png(*bytes))
    return fail(ErrorKind::damaged, bytes->name() + " is a PNG file whose first bytes are damaged");
  return open_foreign(bytes, options);
}

}  // namespace

Result<std::unique_ptr<ImageReader>> open_reader(const Bytes& bytes, const ReadOptions& options) {
  auto stored = open_stored(bytes, options);
  if (!stored || !options.working) return stored;
  return to_working(luma_to_rgb(std::move(*stored)), *options.working);
}

Result<std::unique_ptr<ImageReader>> open_reader(const std::string& path,
                                                 const ReadOptions& options) {
  auto bytes = open_bytes(path, static_cast<std::uint64_t>(options.limits.max_spool_bytes));
  if (!bytes) return std::unexpected(bytes.error());
  return open_reader(*bytes, options);
}

Result<Image> read_image(ImageReader& reader, const ReadLimits& limits,
                         std::span<const std::string> channels) {
  // Choose the channels.
  Image image;
  image.spec = reader.spec();
  std::vector<int> chosen(image.spec.channels.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  if (!channels.empty()) {
    chosen.clear();
    image.spec.channels.clear();
    for (const auto& name : channels) {
      const int index = reader.spec().find(name);
      if (index < 0) return fail(ErrorKind::bad_request, "the image has no channel " + name);
      chosen.push_back(index);
      image.spec.channels.push_back(reader.spec().channels[static_cast<std::size_t>(index)]);
    }
  }

  // Read them, a band at a time, so that a file that ends early is found before all memory is
  // touched.
  const Window& data = image.spec.data;
  const double bytes = double(data.pixels()) * double(chosen.size()) * sizeof(float);
  if (bytes > double(limits.max_bytes))
    return fail(ErrorKind::too_large, "the image takes more memory than the limit of " +
                                          std::to_string(limits.max_bytes) + " bytes");
  constexpr int band = 256;
  try {
    image.planes.resize(chosen.size());
    for (auto& plane : image.planes) plane.reserve(static_cast<std::size_t>(data.pixels()));
    // The next band's memory is made ready while this one is decoded; nothing moves.
    const auto make_ready = [&](int end) {
      for (auto& plane : image.planes)
        plane.resize(static_cast<std::size_t>(std::int64_t{end - data.y0} * data.width()));
    };
    if (data.height() > 0) make_ready(std::min(data.y0 + band, data.y1));
    std::vector<float*> rows(chosen.size());
    for (int y = data.y0; y < data.y1; y += band) {
      const int end = std::min(y + band, data.y1);
      for (std::size_t c = 0; c < chosen.size(); ++c)
        rows[c] = image.planes[c].data() + std::int64_t{y - data.y0} * data.width();
      std::future<void> ready;
      if (end < data.y1)
        ready = std::async(make_ready, std::min(end + band, data.y1));
      const auto done = reader.read_rows(y, end, chosen, rows);
      if (ready.valid()) ready.get();
      if (!done) return std::unexpected(done.error());
    }
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory for the image");
  }
  return image;
}

Result<Image> read_image(const std::string& path, const ReadOptions& options,
                         std::span<const std::string> channels) {
  auto reader = open_reader(path, options);
  if (!reader) return std::unexpected(reader.error());
  auto image = read_image(**reader, options.limits, channels);
  if (!image && image.error().message.starts_with("the image"))
    image.error().message.replace(0, 9, path);
  return image;
}

}  // namespace pse::image
