// Header attributes of EXR files to and from an ImageSpec. Included only by the EXR reader and
// writer.
#pragma once

#include <Imath/ImathBox.h>
#include <OpenEXR/ImfHeader.h>

#include <exception>

#include "image/error.h"
#include "image/image.h"

namespace pse::image::exr {

Window window_of(const Imath::Box2i& box);
Imath::Box2i box_of(const Window& window);

// Chromaticities, pixel aspect, frame rate, and every other attribute that can be told as text.
void read_attributes(const Imf::Header& header, ImageSpec& spec);
void write_attributes(const ImageSpec& spec, Imf::Header& header);

// "zip, scan lines", "piz, tiles of 64 x 64, 3 parts".
std::string describe_storage(const Imf::Header& header, int parts);

// What the library's exception means for the user.
ImageError explain(const std::string& file, const std::exception& problem);

}  // namespace pse::image::exr
