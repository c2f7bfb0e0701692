// Reading images, a whole one or rows at a time, so that a huge image need never be wholly in
// memory. open_reader() tells the format by the file's first bytes: EXR and PNG here, tables
// (table.h), everything else through OpenImageIO.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "image/byte_source.h"
#include "image/colour.h"
#include "image/image.h"

namespace pse::image {

// What a file may claim before it is refused as too large.
struct ReadLimits {
  std::int64_t max_pixels = std::int64_t{1} << 31;       // of the data window
  std::int64_t max_bytes = std::int64_t{16} << 30;       // of one whole image in memory
  std::int64_t max_band_bytes = std::int64_t{1} << 30;   // of what must be decoded at once
  std::int64_t max_spool_bytes = std::int64_t{4} << 30;  // of standard input and pipes
  int max_channels = 1024;
};

struct ReadOptions {
  ReadLimits limits;
  // Turn colour channels into linear light with premultiplied alpha and these primaries. Nothing:
  // as stored.
  std::optional<ColourSpace> working = ColourSpace::lin_rec709;
  // Of a stereo file the view whose channels have no prefix; empty: the file's first.
  std::string view;
};

// An open image. Not to be used from two threads at once.
class ImageReader {
 public:
  ImageReader() = default;
  virtual ~ImageReader() = default;
  ImageReader(const ImageReader&) = delete;
  ImageReader& operator=(const ImageReader&) = delete;

  const ImageSpec& spec() const { return spec_; }

  // Rows [y0, y1) of the data window: planes[i] receives channel channels[i] as data-width * (y1 -
  // y0) floats. Any order of rows works; increasing order is fast in every format.
  virtual Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                                 std::span<float* const> planes) = 0;

 protected:
  ImageSpec spec_;
};

Result<std::unique_ptr<ImageReader>> open_reader(const std::string& path,
                                                 const ReadOptions& options = {});
Result<std::unique_ptr<ImageReader>> open_reader(const Bytes& bytes,
                                                 const ReadOptions& options = {});

// The whole image. `channels` limits it to these names; empty: all.
Result<Image> read_image(const std::string& path, const ReadOptions& options = {},
                         std::span<const std::string> channels = {});
Result<Image> read_image(ImageReader& reader, const ReadLimits& limits,
                         std::span<const std::string> channels = {});

// Threads that decode and encode EXR besides the caller's; for the whole process. 0, the default:
// none.
void set_codec_threads(int count);

}  // namespace pse::image
