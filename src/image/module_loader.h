// Shared modules that are opened on demand, found beside the executable, in its lib folder or where
// they were built.
#pragma once

#include <string>

#include "image/error.h"

namespace pse::image {

// The address of `symbol` in lib<name>.so. The module stays loaded until the process ends.
Result<void*> load_module(const std::string& name, const char* symbol);

}  // namespace pse::image
