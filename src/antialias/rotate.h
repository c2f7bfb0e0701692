// A loop's head gives nothing but its condition, so edges met there would be lost. Its instructions
// are copied to where its outcome is known: to the beginning of the body and behind the loop.
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

// For loops with decisions in their heads; the copies' decisions are entered in `decisions`.
void rotate_loops(ir::Function& function, Decisions& decisions);

}  // namespace pse::antialias
