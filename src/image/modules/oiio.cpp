// The module around OpenImageIO: the only home of that library. Loaded by foreign.cpp, on demand.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <memory>
#include <thread>

#include "image/foreign.h"

namespace pse::image {
namespace {

PixelType type_of(const OIIO::TypeDesc& type) {
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
    case OIIO::TypeDesc::INT8:
      return PixelType::uint8;
    case OIIO::TypeDesc::UINT16:
    case OIIO::TypeDesc::INT16:
      return PixelType::uint16;
    case OIIO::TypeDesc::HALF:
      return PixelType::float16;
    case OIIO::TypeDesc::UINT32:
    case OIIO::TypeDesc::INT32:
      return PixelType::uint32;
    default:
      return PixelType::float32;
  }
}

class OiioReader : public ForeignReader {
 public:
  explicit OiioReader(std::unique_ptr<OIIO::ImageInput> file) : file_(std::move(file)) {
    const OIIO::ImageSpec& from = file_->spec();
    spec.data = {from.x, from.y, from.x + from.width, from.y + from.height};
    spec.display = {from.full_x, from.full_y, from.full_x + from.full_width,
                    from.full_y + from.full_height};
    if (spec.display.width() < 1 || spec.display.height() < 1) spec.display = spec.data;
    const PixelType type = type_of(from.format);
    for (int c = 0; c < from.nchannels; ++c) {
      std::string name = from.channel_name(c);
      if (from.nchannels <= 2 && c == 0 &&
          (name == "I" || name == "L" || name == "R" || name == "gray"))
        name = "Y";
      if (name.empty() || spec_has(name)) name = "channel" + std::to_string(c + 1);
      spec.channels.push_back({name, type});
    }

    // The curve: what the file says, else sRGB for whole numbers and light for the rest.
    const std::string space(from.get_string_attribute("oiio:ColorSpace"));
    const bool whole = type == PixelType::uint8 || type == PixelType::uint16;
    spec.transfer = whole ? Transfer::srgb : Transfer::linear;
    if (space == "Linear" || space == "linear" || space == "lin_srgb" || space == "lin_rec709")
      spec.transfer = Transfer::linear;
    if (space == "sRGB") spec.transfer = Transfer::srgb;
    if (const float gamma = from.get_float_attribute("oiio:Gamma");
        space.starts_with("Gamma") && gamma > 0.1f) {
      spec.transfer = gamma == 1 ? Transfer::linear : Transfer::power;
      spec.gamma = gamma;
    }
    if (from.get_int_attribute("oiio:UnassociatedAlpha") != 0) spec.alpha = Alpha::straight;
    spec.format = file_->format_name();
    for (const auto& attribute : from.extra_attribs)
      if (attribute.type() == OIIO::TypeDesc::STRING)
        spec.attributes[attribute.name().string()] = attribute.get_string();
  }

  bool read_rows(int y0, int y1, float* to, std::string& error) override {
    const OIIO::ImageSpec& from = file_->spec();
    if (from.tile_width == 0) {
      const bool good =
          file_->read_scanlines(0, 0, y0, y1, 0, 0, from.nchannels, OIIO::TypeDesc::FLOAT, to);
      if (!good) error = file_->geterror();
      return good;
    }
    // Tiles come by whole rows of tiles; the last one read is kept.
    const std::size_t row =
        static_cast<std::size_t>(from.width) * static_cast<std::size_t>(from.nchannels);
    for (int y = y0; y < y1; ++y) {
      const int first = from.y + (y - from.y) / from.tile_height * from.tile_height;
      if (first != band_y_ || band_.empty()) {
        const int end = std::min(first + from.tile_height, from.y + from.height);
        band_.resize(row * static_cast<std::size_t>(end - first));
        band_y_ = first;
        if (!file_->read_tiles(0, 0, from.x, from.x + from.width, first, end, 0, 1, 0,
                               from.nchannels, OIIO::TypeDesc::FLOAT, band_.data())) {
          error = file_->geterror();
          band_.clear();
          return false;
        }
      }
      std::copy_n(band_.data() + row * static_cast<std::size_t>(y - first), row,
                  to + row * static_cast<std::size_t>(y - y0));
    }
    return true;
  }

 private:
  bool spec_has(const std::string& name) const {
    return std::any_of(spec.channels.begin(), spec.channels.end(),
                       [&](const auto& c) { return c.name == name; });
  }

  std::unique_ptr<OIIO::ImageInput> file_;
  std::vector<float> band_;
  int band_y_ = 0;
};

// The library's view of a ForeignStream.
class Stream : public OIIO::Filesystem::IOProxy {
 public:
  explicit Stream(ForeignStream& to) : IOProxy("", Write), to_(to) {}

  const char* proxytype() const override { return "pse"; }
  std::size_t write(const void* from, std::size_t count) override {
    pwrite(from, count, m_pos);
    m_pos += static_cast<std::int64_t>(count);
    return count;
  }
  std::size_t pwrite(const void* from, std::size_t count, std::int64_t at) override {
    to_.write(static_cast<std::uint64_t>(at), from, count);
    size_ = std::max(size_, static_cast<std::size_t>(at) + count);
    return count;
  }
  std::size_t size() const override { return size_; }

 private:
  ForeignStream& to_;
  std::size_t size_ = 0;
};

class OiioWriter : public ForeignWriter {
 public:
  OiioWriter(std::unique_ptr<Stream> stream, std::unique_ptr<OIIO::ImageOutput> file)
      : stream_(std::move(stream)), file_(std::move(file)) {}

  bool write_rows(int y, int count, const float* from, std::string& error) override {
    const bool good = file_->write_scanlines(y, y + count, 0, OIIO::TypeDesc::FLOAT, from);
    if (!good) error = file_->geterror();
    return good;
  }
  bool close(std::string& error) override {
    const bool good = file_->close();
    if (!good) error = file_->geterror();
    return good;
  }

 private:
  std::unique_ptr<Stream> stream_;
  std::unique_ptr<OIIO::ImageOutput> file_;
};

std::ptrdiff_t threads_here() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

// Colours and decoding must not depend on how many processors there are.
void use_one_thread() {
  static const bool done = [] {
    const std::ptrdiff_t before = threads_here();
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    // The library starts threads to end them. A process forked while one of these holds a lock
    // would wait for it for ever.
    for (int i = 0; i < 1000 && threads_here() > before; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  }();
  (void)done;
}

// Readers are opened in a process forked from ours (foreign_child.h). So nothing that starts
// threads is asked of the library before: a lock that one of them held would stay locked there.
class OiioImages : public ForeignImages {
 public:
  ForeignReader* open(const std::string& path, std::string& error) override {
    try {
      use_one_thread();
      OIIO::ImageSpec wanted;
      wanted["oiio:UnassociatedAlpha"] = 1;
      auto file = OIIO::ImageInput::open(path, &wanted);
      if (!file) {
        error = OIIO::geterror();
        return nullptr;
      }
      if (file->spec().depth > 1 || file->spec().deep) {
        error = "volumes and deep images are not read";
        return nullptr;
      }
      return new OiioReader(std::move(file));
    } catch (const std::exception& problem) {
      error = problem.what();
      return nullptr;
    }
  }

  ForeignWriter* create(ForeignStream& to, const std::string& format, const ForeignLayout& layout,
                        const std::map<std::string, std::string>& attributes,
                        std::string& error) override {
    try {
      use_one_thread();
      auto file = OIIO::ImageOutput::create(format == "ppm" ? "pnm" : format);
      if (!file) {
        error = OIIO::geterror();
        return nullptr;
      }
      const auto type = layout.type == PixelType::uint8    ? OIIO::TypeDesc::UINT8
                        : layout.type == PixelType::uint16 ? OIIO::TypeDesc::UINT16
                                                           : OIIO::TypeDesc::FLOAT;
      OIIO::ImageSpec spec(layout.width, layout.height, layout.channels, type);
      spec.alpha_channel = layout.alpha ? layout.channels - 1 : -1;
      spec["oiio:UnassociatedAlpha"] = layout.alpha ? 1 : 0;
      // Of TIFF this would add an EXIF part, which OpenImageIO 2.4 cannot put into a stream: the
      // file would be broken.
      if (format != "tiff") spec["oiio:ColorSpace"] = layout.srgb ? "sRGB" : "Linear";
      if (layout.dither && type == OIIO::TypeDesc::UINT8) spec["oiio:dither"] = 1;
      if (format == "jpeg") {
        spec["Compression"] = "jpeg:" + std::to_string(layout.quality);
        spec["jpeg:subsampling"] = "4:4:4";
      }
      if (format == "webp") spec["Compression"] = "webp:" + std::to_string(layout.quality);
      if (format == "tiff") spec["compression"] = "zip";
      std::string story;
      for (const auto& [name, text] : attributes) story += name + ": " + text + "\n";
      if (!story.empty() && story.size() < 60'000 && (format == "jpeg" || format == "tiff"))
        spec["ImageDescription"] = story;
      auto stream = std::make_unique<Stream>(to);
      if (!file->supports("ioproxy") || !file->set_ioproxy(stream.get()) ||
          !file->open("image." + format, spec)) {
        error = file->geterror();
        return nullptr;
      }
      return new OiioWriter(std::move(stream), std::move(file));
    } catch (const std::exception& problem) {
      error = problem.what();
      return nullptr;
    }
  }
};

}  // namespace
}  // namespace pse::image

extern "C" pse::image::ForeignImages* pse_foreign_images() {
  static pse::image::OiioImages images;
  return &images;
}
