// The edges that a sample has met so far on its way through the program, as values of the IR:
// two lines, each a distance and a normal (antialias/derive.h, Edges).
#pragma once

#include <array>

#include "passes/emit.h"

namespace pse::antialias {

using passes::Emit;
using EdgeState = std::array<ir::Value, 6>;

EdgeState start_edges(const Emit& emit);

// With one more edge, where f is 0 and (gx, gy) is its slope per pixel. The same line seen twice,
// or from its other side, counts once. Where there is no slope there is no edge.
EdgeState see_edge(const Emit& emit, const EdgeState& before, ir::Value f, ir::Value gx,
                   ir::Value gy);

}  // namespace pse::antialias
