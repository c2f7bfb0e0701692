// Images stored as luminance and two colour differences, Y RY BY, the differences often at half
// size.
#pragma once

#include "image/reader.h"

namespace pse::image {

// A reader whose Y RY BY are R G B. Images without these channels pass as they are.
std::unique_ptr<ImageReader> luma_to_rgb(std::unique_ptr<ImageReader> stored);

}  // namespace pse::image
