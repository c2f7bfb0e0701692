// EXR files, read through the OpenEXR library. No type of that library leaves the .cpp file.
#pragma once

#include "image/reader.h"

namespace pse::image {

// Scan lines, tiles, many parts, sub-sampled channels; of mip-maps the full size. Deep data is
// refused.
Result<std::unique_ptr<ImageReader>> open_exr(const Bytes& bytes, const ReadOptions& options);

}  // namespace pse::image
