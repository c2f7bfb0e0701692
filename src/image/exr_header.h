// A first look at an EXR file that trusts nothing in it: sizes are checked against the file and the
// limits before the OpenEXR library allocates anything from them.
#pragma once

#include "image/reader.h"

namespace pse::image {

// Whether these are the first bytes of an EXR file.
bool is_exr(const ByteSource& bytes);

// Nothing wrong, or why the file is refused.
Result<void> check_exr_header(const ByteSource& bytes, const ReadLimits& limits);

}  // namespace pse::image
