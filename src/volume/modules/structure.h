// The skeleton of a VDB file, walked before OpenVDB reads it: its counts and lengths are believed
// by the library, and a damaged one would make it wait or allocate for ever.
#pragma once

#include <string>

#include "volume/vdb.h"

namespace pse::volume {

// Follows header, metadata and grid descriptors as far as they must agree with the file's length.
Result<void> check_structure(const std::string& file);

}  // namespace pse::volume
