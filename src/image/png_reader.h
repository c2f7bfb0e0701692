// PNG files, read row by row through libpng.
#pragma once

#include "image/reader.h"

namespace pse::image {

bool is_png(const ByteSource& bytes);
// Whether only the guards around the letters PNG are broken, as by a transfer in text mode.
bool is_almost_png(const ByteSource& bytes);

// Channels Y, Y A, R G B or R G B A, values as stored / the largest. Palettes and transparent
// colours are resolved.
Result<std::unique_ptr<ImageReader>> open_png(const Bytes& bytes, const ReadOptions& options);

}  // namespace pse::image
