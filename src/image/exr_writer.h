// EXR files, written through the OpenEXR library. No type of that library leaves the .cpp file.
#pragma once

#include "image/writer.h"

namespace pse::image {

// Scan lines or tiles, half, float and uint channels. Numbers beyond the range of half are cut to
// its largest.
Result<std::unique_ptr<ImageWriter>> open_exr_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options);

}  // namespace pse::image
