// Our side of the border to the OpenImageIO module; see foreign.h.
#include "image/foreign.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "image/display.h"
#include "image/foreign_child.h"
#include "image/module_loader.h"
#include "image/output_file.h"

namespace pse::image {
namespace {

Result<ForeignImages*> foreign_images() {
  static const Result<ForeignImages*> images = []() -> Result<ForeignImages*> {
    const auto entry = load_module("pse_oiio", foreign_images_entry);
    if (!entry) return std::unexpected(entry.error());
    return reinterpret_cast<ForeignImagesEntry>(*entry)();
  }();
  return images;
}

// Bytes in memory as a file that a library can open by name.
class MemoryFile {
 public:
  MemoryFile() = default;
  ~MemoryFile() {
    if (file_ >= 0) ::close(file_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  bool fill(const ByteSource& bytes) {
    file_ = ::memfd_create("pse-image", MFD_CLOEXEC);
    std::vector<char> block(std::size_t{1} << 16);
    for (std::uint64_t at = 0; file_ >= 0;) {
      const std::int64_t got = bytes.read_at(at, block.data(), block.size());
      if (got <= 0) return got == 0;
      for (std::int64_t put = 0; put < got;) {
        const ssize_t n = ::write(file_, block.data() + put, static_cast<std::size_t>(got - put));
        if (n <= 0) return false;
        put += n;
      }
      at += static_cast<std::uint64_t>(got);
    }
    return false;
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_ = -1;
};

class Reader : public ImageReader {
 public:
  Reader(std::string name, std::unique_ptr<MemoryFile> memory, std::unique_ptr<ForeignReader> file)
      : name_(std::move(name)), memory_(std::move(memory)), file_(std::move(file)) {
    spec_ = file_->spec;
  }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    if (y0 < spec_.data.y0 || y1 > spec_.data.y1 || y0 > y1 || channels.size() != planes.size())
      return fail(ErrorKind::bad_request, "rows outside " + name_);
    const std::size_t step = spec_.channels.size();
    const std::size_t pixels =
        static_cast<std::size_t>(spec_.data.width()) * static_cast<std::size_t>(y1 - y0);
    band_.resize(pixels * step);
    std::string error;
    if (pixels > 0 && !file_->read_rows(y0, y1, band_.data(), error))
      return fail(ErrorKind::damaged, name_ + " is damaged or incomplete (" + error + ")");
    for (std::size_t i = 0; i < channels.size(); ++i)
      for (std::size_t p = 0; p < pixels; ++p)
        planes[i][p] = band_[p * step + static_cast<std::size_t>(channels[i])];
    return {};
  }

 private:
  std::string name_;
  std::unique_ptr<MemoryFile> memory_;
  std::unique_ptr<ForeignReader> file_;
  std::vector<float> band_;
};

class Writer : public ImageWriter, ForeignStream {
 public:
  Writer(const ImageSpec& spec, OutputFile file, DisplayTransform transform,
         bool keep_premultiplied)
      : ImageWriter(spec, file.name()),
        file_(std::move(file)),
        transform_(std::move(transform)),
        keep_premultiplied_(keep_premultiplied) {}

  Result<void> start(ForeignImages& images, const std::string& format,
                     const ForeignLayout& layout) {
    std::string error;
    to_.reset(images.create(*this, format, layout, spec_.attributes, error));
    if (!to_ || file_.failed()) return refuse(error);
    return {};
  }

  void write(std::uint64_t at, const void* from, std::size_t count) override {
    if (file_.tell() != at && !file_.seek(at)) return;
    file_.write(from, count);
  }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    const auto values = static_cast<std::size_t>(spec_.data.width()) *
                        static_cast<std::size_t>(transform_.channels().count());
    band_.resize(values * static_cast<std::size_t>(count));
    std::vector<const float*> row(planes.begin(), planes.end());
    for (int i = 0; i < count; ++i) {
      float* to = band_.data() + values * static_cast<std::size_t>(i);
      transform_.row(row, spec_.data.width(), keep_premultiplied_, to);
      for (auto& plane : row) plane += stride;
    }
    std::string error;
    const bool good = to_->write_rows(y - spec_.data.y0, count, band_.data(), error);
    if (!good || file_.failed()) return refuse(error);
    return {};
  }

  Result<void> finish() override {
    std::string error;
    if (!to_->close(error)) return refuse(error);
    if (file_.failed()) return std::unexpected(file_.error());
    return file_.commit();
  }

 private:
  Result<void> refuse(const std::string& error) const {
    if (file_.failed()) return std::unexpected(file_.error());
    return fail(ErrorKind::cannot_write, "cannot write " + name_ + ": " + error);
  }

  OutputFile file_;
  DisplayTransform transform_;
  bool keep_premultiplied_;
  std::unique_ptr<ForeignWriter> to_;
  std::vector<float> band_;
};

}  // namespace

Result<std::unique_ptr<ImageReader>> open_foreign(const Bytes& bytes, const ReadOptions& options) {
  const std::string& name = bytes->name();
  const auto unknown = [&](const std::string& why) {
    return fail(ErrorKind::not_an_image, name + " is not an image of a known format" +
                                             (why.empty() ? "" : " (" + why + ")"));
  };
  // What is not a plain file is shown to the library as one.
  std::unique_ptr<MemoryFile> memory;
  std::string path = name;
  if (!bytes->is_file()) {
    memory = std::make_unique<MemoryFile>();
    if (!memory->fill(*bytes)) return fail(ErrorKind::cannot_read, "not enough memory for " + name);
    path = memory->path();
  }
  std::string error;
  // Loaded here, so that not every child has to.
  const auto images = foreign_images();
  if (!images) return unknown(images.error().message);
  std::unique_ptr<ForeignReader> file = open_in_child(
      [&](std::string& problem) {
        return std::unique_ptr<ForeignReader>((*images)->open(path, problem));
      },
      bytes->size(), error);
  if (!file) return unknown(error);

  const ImageSpec& spec = file->spec;
  if (spec.data.width() < 1 || spec.data.height() < 1 || spec.channels.empty())
    return fail(ErrorKind::damaged, name + " has no pixels");
  const double pixels = double(spec.data.width()) * double(spec.data.height());
  const double row = double(spec.data.width()) * double(spec.channels.size() * sizeof(float));
  if (pixels > double(options.limits.max_pixels) || row > double(1 << 26) ||
      static_cast<int>(spec.channels.size()) > options.limits.max_channels)
    return fail(ErrorKind::too_large,
                name + " claims more pixels or channels than the limits allow");
  return std::make_unique<Reader>(name, std::move(memory), std::move(file));
}

bool is_foreign_format(std::string_view format) {
  constexpr std::array<std::string_view, 7> known = {"jpeg", "tiff", "targa", "bmp",
                                                     "ppm",  "webp", "hdr"};
  return std::find(known.begin(), known.end(), format) != known.end();
}

Result<std::unique_ptr<ImageWriter>> open_foreign_writer(const std::string& path,
                                                         const std::string& format,
                                                         const ImageSpec& spec,
                                                         const WriteOptions& options) {
  auto chosen = pick_display_channels(spec, path);
  if (!chosen) return std::unexpected(chosen.error());
  auto images = foreign_images();
  if (!images) return std::unexpected(images.error());

  // Formats without alpha keep light over black; grey is written as three colours where they know
  // no grey.
  ForeignLayout layout;
  const bool no_alpha = format == "jpeg" || format == "ppm" || format == "hdr" || format == "bmp";
  const bool no_grey = format == "hdr" || format == "webp" || format == "targa";
  if (no_alpha) chosen->alpha = -1;
  if (no_grey && chosen->values.size() == 1) chosen->values.assign(3, chosen->values[0]);
  const bool light = format == "hdr";
  layout.width = spec.data.width();
  layout.height = spec.data.height();
  layout.channels = chosen->count();
  layout.alpha = chosen->alpha >= 0;
  layout.type = light                                                         ? PixelType::float32
                : options.bits == 16 && (format == "tiff" || format == "ppm") ? PixelType::uint16
                                                                              : PixelType::uint8;
  layout.dither = options.dither && chosen->colour;
  layout.srgb = !light && chosen->colour && options.tone != Tone::raw;
  layout.quality = options.quality;

  auto transform = DisplayTransform::create(std::move(*chosen), options.working,
                                            light ? Tone::raw : options.tone, options.ocio);
  if (!transform) return std::unexpected(transform.error());
  auto file = OutputFile::create(path, options.sync);
  if (!file) return std::unexpected(file.error());
  auto writer = std::make_unique<Writer>(spec, std::move(*file), std::move(*transform), no_alpha);
  if (auto begun = writer->start(**images, format, layout); !begun)
    return std::unexpected(begun.error());
  return writer;
}

}  // namespace pse::image
