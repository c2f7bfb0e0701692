// Writing PNG; see png_writer.h.
#include "image/png_writer.h"

#include <algorithm>
#include <bit>

#include "image/display.h"
#include "image/output_file.h"
#include "image/png_guard.h"

namespace pse::image {
namespace {

void put_bytes(png_structp png, png_bytep from, std::size_t count) {
  auto* file = static_cast<OutputFile*>(png_get_io_ptr(png));
  if (!file->write(from, count)) png_error(png, "cannot write");
}

void flush_nothing(png_structp) {}

class PngWriter : public ImageWriter {
 public:
  PngWriter(const ImageSpec& spec, const WriteOptions& options, OutputFile file,
            DisplayTransform transform)
      : ImageWriter(spec, file.name()),
        file_(std::move(file)),
        transform_(std::move(transform)),
        options_(options) {
    png_ =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble_, png::on_error, png::on_warning);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) throw std::bad_alloc();
  }
  ~PngWriter() override { png_destroy_write_struct(&png_, &info_); }

  Result<void> start() {
    const auto& chosen = transform_.channels();
    const int kind = (chosen.values.size() == 3 ? PNG_COLOR_MASK_COLOR : 0) |
                     (chosen.alpha >= 0 ? PNG_COLOR_MASK_ALPHA : 0);
    const bool for_display = chosen.colour && options_.tone != Tone::raw;

    // Provenance and other texts, compressed, as UTF-8. Keywords are limited to 79 bytes.
    std::vector<png_text> texts;
    for (const auto& [name, text] : spec_.attributes) {
      if (name.empty() || name.size() > 79) continue;
      png_text entry{};
      entry.compression = PNG_ITXT_COMPRESSION_zTXt;
      entry.key = const_cast<char*>(name.c_str());
      entry.text = const_cast<char*>(text.c_str());
      entry.itxt_length = text.size();
      static char none[1] = {};
      entry.lang = none;
      entry.lang_key = none;
      texts.push_back(entry);
    }
    const png_text* text = texts.data();
    const int text_count = static_cast<int>(texts.size());
    const bool good = png::guarded(png_, [&] {
      png_set_write_fn(png_, &file_, put_bytes, flush_nothing);
      png_set_user_limits(png_, 0x7fffffff, 0x7fffffff);
      png_set_IHDR(png_, info_, static_cast<png_uint_32>(spec_.data.width()),
                   static_cast<png_uint_32>(spec_.data.height()), options_.bits, kind,
                   PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
      png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
      png_set_compression_level(png_, 4);
      if (for_display) png_set_sRGB(png_, info_, PNG_sRGB_INTENT_PERCEPTUAL);
      if (!for_display) png_set_gAMA(png_, info_, 1.0);
      if (text_count > 0) png_set_text(png_, info_, text, text_count);
      png_write_info(png_, info_);
      if (options_.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png_);
    });
    if (!good) return std::unexpected(explain());
    const auto values =
        static_cast<std::size_t>(chosen.count()) * static_cast<std::size_t>(spec_.data.width());
    display_.resize(values);
    stored_.resize(values * (options_.bits == 16 ? 2 : 1));
    return {};
  }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    std::vector<const float*> row(planes.begin(), planes.end());
    for (int i = 0; i < count; ++i) {
      transform_.row(row, spec_.data.width(), false, display_.data());
      quantise(y + i);
      unsigned char* bytes = stored_.data();
      if (!png::guarded(png_, [&] { png_write_row(png_, bytes); }))
        return std::unexpected(explain());
      for (auto& plane : row) plane += stride;
    }
    return {};
  }

  Result<void> finish() override {
    if (!png::guarded(png_, [&] { png_write_end(png_, nullptr); }))
      return std::unexpected(explain());
    return file_.commit();
  }

 private:
  void quantise(int y) {
    const std::size_t n = static_cast<std::size_t>(transform_.channels().count());
    const bool spread =
        options_.dither && transform_.channels().colour && options_.tone != Tone::raw;
    for (std::size_t i = 0; i < display_.size(); ++i) {
      if (options_.bits == 16) {
        const std::uint16_t steps = to_16_bits(display_[i]);
        std::copy_n(reinterpret_cast<const unsigned char*>(&steps), 2, stored_.data() + 2 * i);
      } else {
        const float threshold = spread ? dither(static_cast<int>(i / n), y) : 0.5f;
        stored_[i] = to_8_bits(display_[i], threshold);
      }
    }
  }

  ImageError explain() const {
    if (file_.failed()) return file_.error();
    return {ErrorKind::cannot_write, "cannot write " + name_ + ": " + trouble_.message};
  }

  OutputFile file_;
  DisplayTransform transform_;
  WriteOptions options_;
  png::Trouble trouble_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::vector<float> display_;
  std::vector<unsigned char> stored_;
};

}  // namespace

Result<std::unique_ptr<ImageWriter>> open_png_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options) {
  if (options.bits != 8 && options.bits != 16)
    return fail(ErrorKind::bad_request, "PNG is written with 8 or 16 bits");
  auto chosen = pick_display_channels(spec, path);
  if (!chosen) return std::unexpected(chosen.error());
  auto transform = DisplayTransform::create(std::move(*chosen), options.working, options.tone,
                                            options.ocio);
  if (!transform) return std::unexpected(transform.error());
  auto file = OutputFile::create(path, options.sync);
  if (!file) return std::unexpected(file.error());
  auto writer = std::make_unique<PngWriter>(spec, options, std::move(*file), std::move(*transform));
  if (auto begun = writer->start(); !begun) return std::unexpected(begun.error());
  return writer;
}

}  // namespace pse::image
