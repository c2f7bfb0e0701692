// What all writers share: the order of rows, tiles collected into rows, the choice of format; see
// writer.h.
#include "image/writer.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "image/exr_writer.h"
#include "image/foreign.h"
#include "image/framed.h"
#include "image/png_writer.h"
#include "image/table.h"

namespace pse::image {

Result<void> ImageWriter::write_rows(int count, std::span<const float* const> planes,
                                     std::ptrdiff_t stride) {
  if (!started_) next_ = spec_.data.y0;
  started_ = true;
  if (failed_ || closed_) return fail(ErrorKind::cannot_write, "writing " + name_ + " has failed");
  if (count < 0 || next_ + count > spec_.data.y1 || planes.size() != spec_.channels.size())
    return fail(ErrorKind::bad_request, "rows or channels that " + name_ + " does not have");
  if (count == 0) return {};
  auto done = put_rows(next_, count, planes, stride != 0 ? stride : spec_.data.width());
  failed_ = !done;
  next_ += count;
  return done;
}

Result<void> ImageWriter::write_tile(const Window& tile, std::span<const float* const> planes) {
  const int width = spec_.data.width();
  if (!started_) next_ = spec_.data.y0;
  started_ = true;

  // Tiles as wide as the image are rows already.
  if (band_filled_ == 0 && tile.y0 == next_ && tile.x0 == spec_.data.x0 && tile.x1 == spec_.data.x1)
    return write_rows(tile.height(), planes);

  // The first tile of a row of tiles opens the band.
  if (band_filled_ == 0) {
    band_ = {spec_.data.x0, next_, spec_.data.x1, tile.y1};
    band_planes_.resize(spec_.channels.size());
    for (auto& plane : band_planes_)
      plane.resize(static_cast<std::size_t>(std::max<std::int64_t>(band_.pixels(), 0)));
  }
  if (tile.y0 != band_.y0 || tile.y1 != band_.y1 || tile.x0 < band_.x0 || tile.x1 > band_.x1 ||
      tile.y1 > spec_.data.y1 || tile.width() <= 0 || tile.height() <= 0 ||
      planes.size() != band_planes_.size())
    return fail(ErrorKind::bad_request, "a tile out of order for " + name_);
  for (std::size_t c = 0; c < planes.size(); ++c)
    for (int row = 0; row < tile.height(); ++row)
      std::copy_n(planes[c] + std::ptrdiff_t{row} * tile.width(), tile.width(),
                  band_planes_[c].data() + std::ptrdiff_t{row} * width + (tile.x0 - band_.x0));

  // The last one closes it.
  band_filled_ += tile.pixels();
  if (band_filled_ < band_.pixels()) return {};
  band_filled_ = 0;
  std::vector<const float*> rows;
  for (const auto& plane : band_planes_) rows.push_back(plane.data());
  return write_rows(band_.height(), rows);
}

Result<void> ImageWriter::close() {
  if (!started_) next_ = spec_.data.y0;
  if (closed_ || failed_) return fail(ErrorKind::cannot_write, "writing " + name_ + " has failed");
  closed_ = true;
  if (next_ != spec_.data.y1)
    return fail(ErrorKind::bad_request, "not all rows of " + name_ + " were written");
  return finish();
}

std::optional<Compression> compression_from_name(std::string_view name) {
  constexpr std::array<std::string_view, 10> names = {"none",  "rle", "zips", "zip",  "piz",
                                                      "pxr24", "b44", "b44a", "dwaa", "dwab"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Compression>(found - names.begin());
}

std::string format_of_name(const std::string& path) {
  const auto slash = path.rfind('/');
  const auto dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return {};
  std::string ending = path.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == "jpg" || ending == "jpe") return "jpeg";
  if (ending == "tif") return "tiff";
  if (ending == "tga") return "targa";
  if (ending == "rgbe") return "hdr";
  if (ending == "pgm" || ending == "pnm") return "ppm";
  return ending;
}

bool is_display_format(std::string_view format) { 
  return format != "exr" && format != "hdr" && format != "csv";
}

Result<std::unique_ptr<ImageWriter>> open_writer(const std::string& path, const ImageSpec& spec,
                                                 const WriteOptions& options) {
  std::string format = options.format.empty() ? format_of_name(path) : options.format;
  if (path == "-" && options.format.empty()) format = "exr";
  const std::string shown = path == "-" ? "standard output" : path;

  // What no format can hold.
  constexpr int far = 1 << 29;
  const Window& w = spec.data;
  if (spec.channels.empty())
    return fail(ErrorKind::bad_request, "there is nothing to write to " + shown);
  if (w.width() < 1 || w.height() < 1 || spec.display.width() < 1 || spec.display.height() < 1)
    return fail(ErrorKind::bad_request, "the image for " + shown + " has no pixels");
  if (w.x0 < -far || w.y0 < -far || w.x1 > far || w.y1 > far || spec.display.x0 < -far ||
      spec.display.y0 < -far || spec.display.x1 > far || spec.display.y1 > far)
    return fail(ErrorKind::too_large, "the image for " + shown + " is too large");
  for (std::size_t i = 0; i < spec.channels.size(); ++i) {
    const std::string& name = spec.channels[i].name;
    if (name.empty() || name.size() > 255 || name.find('\0') != std::string::npos)
      return fail(ErrorKind::bad_request, "a channel for " + shown + " has no usable name");
    if (spec.find(name) != static_cast<int>(i))
      return fail(ErrorKind::bad_request, "two channels for " + shown + " have the name " + name);
  }

  if (format == "exr") return open_exr_writer(path, spec, options);

  // Other formats know no windows: they get the whole frame.
  ImageSpec framed = spec;
  framed.data = framed.display = {0, 0, spec.display.width(), spec.display.height()};
  Result<std::unique_ptr<ImageWriter>> writer = fail(
      ErrorKind::unsupported,
      "the name " + shown +
          " does not say a format that can be written; use .exr, .png, .jpg, .tif, .csv or .mp4");
  if (format == "csv") writer = open_csv_writer(path, framed, options);
  if (format == "png") writer = open_png_writer(path, framed, options);
  if (is_foreign_format(format)) writer = open_foreign_writer(path, format, framed, options);
  if (!writer || spec.data == spec.display) return writer;
  return put_in_frame(std::move(*writer), spec);
}

Result<void> write_image(const std::string& path, const Image& image, const WriteOptions& options) {
  auto writer = open_writer(path, image.spec, options);
  if (!writer) return std::unexpected(writer.error());
  std::vector<const float*> planes;
  for (const auto& plane : image.planes) planes.push_back(plane.data());
  if (auto done = (*writer)->write_rows(image.spec.data.height(), planes); !done) return done;
  return (*writer)->close();
}

}  // namespace pse::image
