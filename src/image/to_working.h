// Brings what a file stores to what programs see: linear light, premultiplied alpha, the working
// space's primaries. Only colour channels (R G B, Y, and such triples in layers) are touched; data
// channels pass as they are.
#pragma once

#include "image/reader.h"

namespace pse::image {

std::unique_ptr<ImageReader> to_working(std::unique_ptr<ImageReader> stored, ColourSpace working);

}  // namespace pse::image
