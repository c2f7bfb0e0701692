// What a program makes of the pixels' own numbers, px and py, that is no picture between pixels:
// the chance of a dither or of a ray's first step. Its decisions are no edges. Places in pixels,
// which change little from one to the next, are as good as x and y.
#pragma once

#include <vector>

#include "ir/module.h"

namespace pse::antialias {

// By value of the main function: whether it depends on a hash of px and py, or on whole numbers
// that change at least once from pixel to pixel because of these; without `hashes` on whole
// numbers of pixels alone, which are the same all over a pixel. `module` is as it comes from the
// lowering.
std::vector<bool> find_dither(const ir::Module& module, bool hashes = true);

}  // namespace pse::antialias
