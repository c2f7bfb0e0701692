// Writing EXR; see exr_writer.h. Memory is bounded: one band of rows in the stored types.
#include "image/exr_writer.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "image/exr_attributes.h"
#include "image/output_file.h"

namespace pse::image {
namespace {

constexpr int band_rows = 256;

// The library's view of an OutputFile.
class OutStream : public Imf::OStream {
 public:
  OutStream(OutputFile& file) : Imf::OStream(file.name().c_str()), file_(file) {}
  void write(const char from[], int count) override {
    if (!file_.write(from, static_cast<std::size_t>(count))) throw Iex::IoExc("cannot write");
  }
  std::uint64_t tellp() override { return file_.tell(); }
  void seekp(std::uint64_t position) override {
    if (!file_.seek(position)) throw Iex::IoExc("cannot write");
  }

 private:
  OutputFile& file_;
};

constexpr float half_max = 65504.0f;

std::uint16_t to_half(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -half_max, half_max);
  return Imath::half(value).bits();
}

std::uint32_t to_uint(float value) {
  if (!(value > 0)) return 0;
  if (value >= 4294967040.0f) return 0xffffffffu;
  return static_cast<std::uint32_t>(std::llrint(value));
}

class ExrWriter : public ImageWriter {
 public:
  ExrWriter(const ImageSpec& spec, const WriteOptions& options, OutputFile file)
      : ImageWriter(spec, file.name()), file_(std::move(file)), stream_(file_) {
    Imf::Header header(exr::box_of(spec.display), exr::box_of(spec.data));
    exr::write_attributes(spec, header);
    header.compression() = static_cast<Imf::Compression>(options.compression);
    for (const auto& channel : spec.channels)
      header.channels().insert(channel.name, Imf::Channel(stored_type(channel.type)));

    // Bands of rows are kept until they are worth a call; tiles need whole rows of tiles.
    rows_ = band_rows;
    if (options.tile_width > 0 && options.tile_height > 0) {
      tile_ = options.tile_height;
      rows_ = tile_;
      header.setTileDescription(Imf::TileDescription(static_cast<unsigned>(options.tile_width),
                                                     static_cast<unsigned>(options.tile_height),
                                                     Imf::ONE_LEVEL));
      tiled_ = std::make_unique<Imf::TiledOutputFile>(stream_, header, Imf::globalThreadCount());
    } else {
      lines_ = std::make_unique<Imf::OutputFile>(stream_, header, Imf::globalThreadCount());
    }
    rows_ = std::min(rows_, spec.data.height());
    band_.resize(spec.channels.size());
    for (std::size_t c = 0; c < band_.size(); ++c)
      band_[c].resize(bytes_of(spec.channels[c].type) * static_cast<std::size_t>(rows_) *
                      static_cast<std::size_t>(spec.data.width()));
  }

  // The library's files write their tables when they are destroyed, also after an error; the errors
  // of that have no way out, and the temporary file is thrown away then in any case.
  ~ExrWriter() override { shut(); }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    try {
      for (int row = 0; row < count; ++row) {
        for (std::size_t c = 0; c < planes.size(); ++c) store(c, planes[c] + row * stride);
        if (++filled_ == rows_ || y + row + 1 == spec_.data.y1) put_band(y + row + 1 - filled_);
      }
      return {};
    } catch (const std::exception& problem) {
      return std::unexpected(explain(problem));
    }
  }

  Result<void> finish() override {
    shut();
    if (file_.failed()) return std::unexpected(file_.error());
    return file_.commit();
  }

 private:
  static Imf::PixelType stored_type(PixelType type) {
    if (type == PixelType::uint32) return Imf::UINT;
    if (type == PixelType::float32) return Imf::FLOAT;
    return Imf::HALF;
  }
  static std::size_t bytes_of(PixelType type) { return stored_type(type) == Imf::HALF ? 2 : 4; }

  // One row of one channel into the band, in the stored type.
  void store(std::size_t c, const float* from) {
    const auto type = stored_type(spec_.channels[c].type);
    const auto width = static_cast<std::size_t>(spec_.data.width());
    char* to = band_[c].data() +
               bytes_of(spec_.channels[c].type) * width * static_cast<std::size_t>(filled_);
    if (type == Imf::FLOAT) {
      std::memcpy(to, from, width * sizeof(float));
    } else if (type == Imf::HALF) {
      auto* halves = reinterpret_cast<std::uint16_t*>(to);
      for (std::size_t x = 0; x < width; ++x) halves[x] = to_half(from[x]);
    } else {
      auto* whole = reinterpret_cast<std::uint32_t*>(to);
      for (std::size_t x = 0; x < width; ++x) whole[x] = to_uint(from[x]);
    }
  }

  // Hands the collected rows, the first of which is `y`, to the library.
  void put_band(int y) {
    Imf::FrameBuffer buffer;
    const auto width = static_cast<std::size_t>(spec_.data.width());
    for (std::size_t c = 0; c < band_.size(); ++c) {
      const std::size_t bytes = bytes_of(spec_.channels[c].type);
      const std::ptrdiff_t back =
          (std::ptrdiff_t{y} * static_cast<std::ptrdiff_t>(width) + spec_.data.x0) *
          static_cast<std::ptrdiff_t>(bytes);
      char* origin =
          reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(band_[c].data()) - back);
      buffer.insert(spec_.channels[c].name,
                    Imf::Slice(stored_type(spec_.channels[c].type), origin, bytes, bytes * width));
    }
    if (tiled_) {
      tiled_->setFrameBuffer(buffer);
      const int row = (y - spec_.data.y0) / tile_;
      tiled_->writeTiles(0, tiled_->numXTiles() - 1, row, row);
    } else {
      lines_->setFrameBuffer(buffer);
      lines_->writePixels(filled_);
    }
    filled_ = 0;
  }

  void shut() {
    try {
      lines_.reset();
      tiled_.reset();
    } catch (...) {
    }
  }

  ImageError explain(const std::exception& problem) const {
    if (file_.failed()) return file_.error();
    return {ErrorKind::cannot_write, "cannot write " + name_ + ": " + problem.what()};
  }

  OutputFile file_;
  OutStream stream_;
  std::unique_ptr<Imf::OutputFile> lines_;
  std::unique_ptr<Imf::TiledOutputFile> tiled_;
  int tile_ = 0, rows_ = 1, filled_ = 0;
  std::vector<std::vector<char>> band_;  // one per channel
};

}  // namespace

Result<std::unique_ptr<ImageWriter>> open_exr_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options) {
  auto file = OutputFile::create(path, options.sync);
  if (!file) return std::unexpected(file.error());
  ImageSpec stored = spec;
  if (!stored.chromaticities && options.working != ColourSpace::lin_rec709)
    stored.chromaticities = chromaticities_of(options.working);
  try {
    return std::make_unique<ExrWriter>(stored, options, std::move(*file));
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory to write " + path);
  } catch (const std::exception& problem) {
    return fail(ErrorKind::cannot_write, "cannot write " + path + ": " + problem.what());
  }
}

}  // namespace pse::image
