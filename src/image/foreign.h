// Formats that are neither EXR nor PNG: TIFF, JPEG, HDR, TGA and whatever else OpenImageIO knows.
// That library takes 400 ms and 130 MB to load, so it stands in a shared module of its own
// (modules/oiio.cpp), opened when such a file first comes: to read in a process of its own
// (foreign_child.h), to write in ours.
#pragma once

#include "image/reader.h"
#include "image/writer.h"

namespace pse::image {

Result<std::unique_ptr<ImageReader>> open_foreign(const Bytes& bytes, const ReadOptions& options);

// Formats that can be written: jpeg, tiff, targa, bmp, ppm, webp (for display) and hdr (light).
bool is_foreign_format(std::string_view format);
Result<std::unique_ptr<ImageWriter>> open_foreign_writer(const std::string& path,
                                                         const std::string& format,
                                                         const ImageSpec& spec,
                                                         const WriteOptions& options);

// What crosses the border to the module: plain data and pure virtual functions, no code.
struct ForeignReader {
  ImageSpec spec;
  virtual ~ForeignReader() = default;
  // Rows of the data window, channels interleaved.
  virtual bool read_rows(int y0, int y1, float* to, std::string& error) = 0;
};

// Where a ForeignWriter puts its bytes. It never reports a failure, because some of the libraries
// behind the border end the process when a write fails; what went wrong is known on our side.
struct ForeignStream {
  virtual ~ForeignStream() = default;
  virtual void write(std::uint64_t at, const void* from, std::size_t count) = 0;
};

struct ForeignWriter {
  virtual ~ForeignWriter() = default;
  virtual bool write_rows(int y, int count, const float* from, std::string& error) = 0;
  virtual bool close(std::string& error) = 0;
};

struct ForeignLayout {
  int width = 0, height = 0, channels = 0;
  bool alpha = false;
  PixelType type = PixelType::uint8;
  bool dither = true, srgb = true;
  int quality = 95;
};

struct ForeignImages {
  virtual ~ForeignImages() = default;
  virtual ForeignReader* open(const std::string& path, std::string& error) = 0;
  virtual ForeignWriter* create(ForeignStream& to, const std::string& format,
                                const ForeignLayout& layout,
                                const std::map<std::string, std::string>& attributes,
                                std::string& error) = 0;
};

// The one symbol of the module.
using ForeignImagesEntry = ForeignImages* (*)();
inline constexpr const char* foreign_images_entry = "pse_foreign_images";

}  // namespace pse::image
