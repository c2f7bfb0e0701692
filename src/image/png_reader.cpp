// Reading PNG; see png_reader.h.
#include "image/png_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "image/png_guard.h"

namespace pse::image {
namespace {

struct Cursor {
  const ByteSource* bytes = nullptr;
  std::uint64_t at = 0;
  bool ended = false;
};

void get_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto* cursor = static_cast<Cursor*>(png_get_io_ptr(png));
  if (cursor->bytes->read_at(cursor->at, to, count) != static_cast<std::int64_t>(count)) {
    cursor->ended = true;
    png_error(png, "the file ends too early");
  }
  cursor->at += count;
}

// Whether the chunks before the pixels lie inside the file: libpng takes memory for a chunk before
// it finds out.
bool chunks_fit(const ByteSource& bytes) {
  for (std::uint64_t at = 8;;) {
    unsigned char head[8] = {};
    if (bytes.read_at(at, head, 8) != 8) return false;
    if (std::memcmp(head + 4, "IDAT", 4) == 0) return true;
    const std::uint64_t length = (std::uint64_t{head[0]} << 24) | (std::uint64_t{head[1]} << 16) |
                                 (std::uint64_t{head[2]} << 8) | head[3];
    at += 12 + length;
    if (at > bytes.size()) return false;
  }
}

class PngReader : public ImageReader {
 public:
  PngReader(Bytes bytes, const ReadOptions& options)
      : bytes_(std::move(bytes)), limits_(options.limits) {}
  ~PngReader() override { png_destroy_read_struct(&png_, &info_, nullptr); }

  Result<void> start() {
    if (!chunks_fit(*bytes_))
      return fail(ErrorKind::truncated,
                  bytes_->name() + " is incomplete: it ends before its pixels");
    if (auto open = begin(); !open) return open;
    describe();
    return {};
  }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    if (y0 < 0 || y1 > spec_.data.y1 || y0 > y1 || channels.size() != planes.size())
      return fail(ErrorKind::bad_request, "rows outside " + bytes_->name());
    for (int y = y0; y < y1; ++y) {
      if (auto there = go_to(y); !there) return there;
      const unsigned char* row =
          interlaced_ ? whole_.data() + row_bytes_ * static_cast<std::size_t>(y) : row_.data();
      for (std::size_t i = 0; i < channels.size(); ++i)
        convert(row, channels[i], planes[i] + std::ptrdiff_t{y - y0} * spec_.data.width());
    }
    return {};
  }

 private:
  // Opens the stream and reads up to the pixels. Used again when rows are asked for a second time.
  Result<void> begin() {
    png_destroy_read_struct(&png_, &info_, nullptr);
    cursor_ = {bytes_.get(), 0, false};
    next_ = 0;
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble_, png::on_error, png::on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) return fail(ErrorKind::too_large, "not enough memory");

    png_uint_32 width = 0, height = 0;
    int depth = 0, kind = 0, interlace = 0;
    bool good = png::guarded(png_, [&] {
      png_set_read_fn(png_, &cursor_, get_bytes);
      png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
      png_set_chunk_malloc_max(png_, png_alloc_size_t{8} << 20);
      png_set_chunk_cache_max(png_, 64);
      png_read_info(png_, info_);
      png_get_IHDR(png_, info_, &width, &height, &depth, &kind, &interlace, nullptr, nullptr);
    });
    if (!good) return std::unexpected(explain());

    // Claims that the limits or the size of the file rule out: deflate makes data at most 1032
    // times smaller.
    const double pixels = double(width) * double(height);
    const double samples =
        (kind & PNG_COLOR_MASK_COLOR) != 0 && kind != PNG_COLOR_TYPE_PALETTE ? 3 : 1;
    if (pixels > double(limits_.max_pixels) || double(width) * 64 > double(limits_.max_band_bytes))
      return fail(ErrorKind::too_large, bytes_->name() + " claims to have " +
                                            std::to_string(width) + " x " + std::to_string(height) +
                                            " pixels, more than the limit of " +
                                            std::to_string(limits_.max_pixels));
    if (pixels * samples * depth / 8 > 1100.0 * double(bytes_->size()))
      return fail(ErrorKind::truncated, bytes_->name() + " claims to have " +
                                            std::to_string(width) + " x " + std::to_string(height) +
                                            " pixels and is far too short for that");

    interlaced_ = interlace != PNG_INTERLACE_NONE;
    good = png::guarded(png_, [&] {
      png_set_expand(png_);
      if (std::endian::native == std::endian::little) png_set_swap(png_);
      if (interlaced_) png_set_interlace_handling(png_);
      png_read_update_info(png_, info_);
      row_bytes_ = png_get_rowbytes(png_, info_);
    });
    if (!good) return std::unexpected(explain());
    row_.resize(row_bytes_);
    spec_.data = spec_.display = {0, 0, static_cast<int>(width), static_cast<int>(height)};
    return {};
  }

  // Fills the spec from the header.
  void describe() {
    const int count = png_get_channels(png_, info_);
    bits_ = png_get_bit_depth(png_, info_);
    const auto type = bits_ == 16 ? PixelType::uint16 : PixelType::uint8;
    if (count >= 3) {
      spec_.channels = {{"R", type}, {"G", type}, {"B", type}};
    } else {
      spec_.channels = {{"Y", type}};
    }
    if (count == 2 || count == 4) spec_.channels.push_back({"A", type});
    spec_.format = "png";
    spec_.storage = std::to_string(bits_) + " bits" + (interlaced_ ? ", interlaced" : "");
    spec_.alpha = Alpha::straight;

    // The curve: sRGB unless the file says another one.
    spec_.transfer = Transfer::srgb;
    double gamma = 0;
    if (png_get_valid(png_, info_, PNG_INFO_sRGB) == 0 && png_get_gAMA(png_, info_, &gamma) != 0) {
      if (std::fabs(gamma - 1) < 0.01) {
        spec_.transfer = Transfer::linear;
      } else if (gamma > 0.05 && gamma < 5 && std::fabs(gamma - 1 / 2.2) > 0.01) {
        spec_.transfer = Transfer::power;
        spec_.gamma = static_cast<float>(1 / gamma);
      }
    }
    Chromaticities c{};
    if (png_get_valid(png_, info_, PNG_INFO_sRGB) == 0 &&
        png_get_cHRM(png_, info_, &c.white[0], &c.white[1], &c.red[0], &c.red[1], &c.green[0],
                     &c.green[1], &c.blue[0], &c.blue[1]) != 0)
      spec_.chromaticities = c;
    png_textp texts = nullptr;
    const int text_count = png_get_text(png_, info_, &texts, nullptr);
    for (int i = 0; i < text_count; ++i)
      if (texts[i].text != nullptr) spec_.attributes[texts[i].key] = texts[i].text;
  }

  // Makes row y the current one. Rows before the current one make it start again.
  Result<void> go_to(int y) {
    if (interlaced_) return read_all();
    if (y < next_ - 1)
      if (auto again = begin(); !again) return again;
    while (next_ <= y) {
      unsigned char* row = row_.data();
      if (!png::guarded(png_, [&] { png_read_row(png_, row, nullptr); }))
        return std::unexpected(explain());
      ++next_;
    }
    return {};
  }

  // An interlaced picture comes in seven passes over all of it.
  Result<void> read_all() {
    if (!whole_.empty()) return {};
    const auto height = static_cast<std::size_t>(spec_.data.height());
    if (double(row_bytes_) * double(height) > double(limits_.max_bytes))
      return fail(ErrorKind::too_large, bytes_->name() + " is too large to read");
    whole_.resize(row_bytes_ * height);
    std::vector<png_bytep> rows;
    for (std::size_t y = 0; y < height; ++y) rows.push_back(whole_.data() + y * row_bytes_);
    png_bytepp first = rows.data();
    if (png::guarded(png_, [&] { png_read_image(png_, first); })) return {};
    whole_.clear();
    return std::unexpected(explain());
  }

  // One channel of a row of interleaved whole numbers to floats.
  void convert(const unsigned char* row, int channel, float* to) const {
    const std::size_t step = spec_.channels.size();
    for (std::size_t x = 0; x < static_cast<std::size_t>(spec_.data.width()); ++x) {
      const std::size_t at = x * step + static_cast<std::size_t>(channel);
      if (bits_ == 16) {
        std::uint16_t steps = 0;
        std::memcpy(&steps, row + 2 * at, 2);
        to[x] = static_cast<float>(steps) / 65535.0f;
      } else {
        to[x] = static_cast<float>(row[at]) / 255.0f;
      }
    }
  }

  ImageError explain() const {
    if (cursor_.ended)
      return {ErrorKind::truncated, bytes_->name() + " is incomplete: it was cut short"};
    return {ErrorKind::damaged, bytes_->name() + " is damaged (" + trouble_.message + ")"};
  }

  Bytes bytes_;
  ReadLimits limits_;
  Cursor cursor_;
  png::Trouble trouble_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  bool interlaced_ = false;
  int bits_ = 8;
  int next_ = 0;  // the row that libpng yields next
  std::size_t row_bytes_ = 0;
  std::vector<unsigned char> row_, whole_;
};

}  // namespace

bool is_png(const ByteSource& bytes) {
  unsigned char start[8] = {};
  return bytes.read_at(0, start, 8) == 8 && png_sig_cmp(start, 0, 8) == 0;
}

bool is_almost_png(const ByteSource& bytes) {
  char start[4] = {};
  return bytes.read_at(0, start, 4) == 4 && std::memcmp(start + 1, "PNG", 3) == 0;
}

Result<std::unique_ptr<ImageReader>> open_png(const Bytes& bytes, const ReadOptions& options) {
  auto reader = std::make_unique<PngReader>(bytes, options);
  if (auto begun = reader->start(); !begun) return std::unexpected(begun.error());
  return reader;
}

}  // namespace pse::image
