// What of a program's outputs changes between edges otherwise than evenly, so that the mean over a
// pixel is not what its middle is. Such outputs are smoothed (smooth.h).
#pragma once

#include <vector>

#include "antialias/decisions.h"

namespace pse::antialias {

enum class Course : std::uint8_t {
  // The same everywhere between two edges, or by even amounts more from pixel to pixel; and data:
  // sums of what the stream brings, places, normals, depths.
  even,
  bent,
  // Made of stored pixels or of pixels' whole numbers, which are the pixel's own.
  fixed,
};

// Of the module's outputs, one after the other. `module` and `decisions` are those of
// find_decisions().
std::vector<Course> find_courses(const ir::Module& module, const Decisions& decisions);

}  // namespace pse::antialias
