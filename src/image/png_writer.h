// PNG files, written row by row through libpng.
#pragma once

#include "image/writer.h"

namespace pse::image {

// Grey or RGB, with straight alpha where there is an A, 8 or 16 bits, through the display
// transform. The data window is the picture: open_writer() puts a frame around it first (framed.h).
Result<std::unique_ptr<ImageWriter>> open_png_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options);

}  // namespace pse::image
