// For formats without windows: the data window is cut to the frame, and the rest of the frame is 0.
#pragma once

#include "image/writer.h"

namespace pse::image {

// `frame` writes the frame whole; the writer returned takes rows of the spec's data window.
std::unique_ptr<ImageWriter> put_in_frame(std::unique_ptr<ImageWriter> frame,
                                          const ImageSpec& spec);

}  // namespace pse::image
