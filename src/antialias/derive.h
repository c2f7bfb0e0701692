// The derivative of a program by the place in the picture: every value that changes from sample to
// sample carries its slopes along x and y with it, in the unit of one pixel (forward mode). With
// the slopes, the sample sees the edges around it: where a - b has the value f and the slope g,
// the edge of `if a < b` lies f / |g| pixels away (2002 chapter, "The High-Contrast Filter", where
// the slope is fitted to neighbouring samples).
#pragma once

#include "antialias/decisions.h"
#include "stream/sample_source.h"

namespace pse::antialias {

// A line that the sample sees: the sample is `distance` pixels from it, positive where the normal
// points to the sample. Pixels, y down.
struct Line {
  float distance, nx, ny;
};
// What a module of edges gives, one output after the other: the nearest line, and the nearest that
// is not the same.
struct Edges {
  Line first, second;
};
inline constexpr std::size_t edge_outputs = 6;
inline constexpr float no_edge = 1e30f;  // as distance: none

// A module fresh from the lowering becomes one that gives the edges around a sample, as the program
// sees them on its way through its conditionals. Its inputs are the old ones, then "NAME$x" and
// "NAME$y" for those of sample rate that change that way: that input's slopes, per pixel; of frame
// rate where they are even.
void derive_edges(ir::Module& module, const Decisions& decisions,
                  const InputChanges& changes = unknown_changes);

// Likewise, but gives the outputs, then "NAME$x" and "NAME$y" for each. For tests and tools.
void derive_outputs(ir::Module& module, const InputChanges& changes = unknown_changes);

}  // namespace pse::antialias
