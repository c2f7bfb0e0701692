// Writing images, fed by rows or by tiles, so that a huge image need never be wholly in memory. The
// file takes its place only at close(); without it, or after any error, what was there before
// stays.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/colour.h"
#include "image/error.h"
#include "image/image.h"
#include "image/ocio.h"

namespace pse::image {

enum class Compression { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };
std::optional<Compression> compression_from_name(std::string_view name);

struct WriteOptions {
  std::string format;  // "exr", "png"...; empty: by the name's extension; standard output: EXR
  // EXR
  Compression compression = Compression::zip;
  int tile_width = 0, tile_height = 0;  // 0: scan lines
  // what the caller's colours are
  ColourSpace working = ColourSpace::lin_rec709;
  // PNG, JPEG and the like
  Tone tone = Tone::clip;
  OcioChoice ocio;        // of Tone::ocio
  int bits = 8;           // 8 or 16
  bool dither = true;
  int quality = 95;  // of lossy formats
  bool sync = true;  // wait for the disk before the file takes its place
};

// An open output. Its caller's channels are linear and premultiplied.
class ImageWriter {
 public:
  ImageWriter(ImageSpec spec, std::string name) : spec_(std::move(spec)), name_(std::move(name)) {}
  virtual ~ImageWriter() = default;
  ImageWriter(const ImageWriter&) = delete;
  ImageWriter& operator=(const ImageWriter&) = delete;

  const ImageSpec& spec() const { return spec_; }
  int next_row() const { return next_; }

  // Rows [next_row(), next_row() + count): planes[c] is channel c of the spec, each row `stride`
  // floats after the last (0: the width of the data window).
  Result<void> write_rows(int count, std::span<const float* const> planes,
                          std::ptrdiff_t stride = 0);

  // A tile, row by row. Tiles of one row of tiles come in any order and have the same height; rows
  // of tiles come from top to bottom.
  Result<void> write_tile(const Window& tile, std::span<const float* const> planes);

  // Finishes the file and puts it in its place. Rows that are missing make it an error.
  Result<void> close();

 protected:
  virtual Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                                std::ptrdiff_t stride) = 0;
  virtual Result<void> finish() = 0;

  ImageSpec spec_;
  std::string name_;

 private:
  int next_ = 0;
  bool started_ = false, failed_ = false, closed_ = false;
  // the row of tiles being collected
  Window band_;
  std::int64_t band_filled_ = 0;
  std::vector<std::vector<float>> band_planes_;
};

Result<std::unique_ptr<ImageWriter>> open_writer(const std::string& path, const ImageSpec& spec,
                                                 const WriteOptions& options = {});
Result<void> write_image(const std::string& path, const Image& image,
                         const WriteOptions& options = {});

// The format that a name asks for: its extension in lower case with synonyms resolved ("jpg" is
// "jpeg").
std::string format_of_name(const std::string& path);
// Whether the format stores colours for display, through the display transform, rather than light.
bool is_display_format(std::string_view format);

}  // namespace pse::image
