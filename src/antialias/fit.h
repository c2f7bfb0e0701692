// A condition's value near a pixel, fitted by least squares to the pixels around it (2002 chapter,
// "The High-Contrast Filter"). With all eight neighbours the fit bends; with fewer it is the
// chapter's plane.
#pragma once

#include <array>
#include <cstdint>

#include "antialias/filter.h"

namespace pse::antialias {

// The eight neighbours, row by row.
inline constexpr std::array<std::array<int, 2>, 8> eight_around = {
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

// Where the value is 0: a line that bends.
struct FittedEdge {
  float distance;  // of the pixel's centre, in pixels; positive where the value is
  float nx, ny;    // towards larger values
  float bend;      // how much the normal turns towards (-ny, nx), per pixel along it
  float share;     // of the kernel on the positive side
  std::array<float, 8> distances;  // of the neighbours from the same line, unbent
};

enum class Fit : std::uint8_t {
  edge,
  none,    // no edge within reach of the kernel
  failed,  // too few neighbours, or they lie on no plane (the chapter's "high variance")
};

// `values[i]` is that of neighbour i, used where bit i of `known` is set; `here` the pixel's own.
Fit fit_edge(float here, const std::array<float, 8>& values, unsigned known, const Filter& filter,
             FittedEdge& edge);

}  // namespace pse::antialias
