// Jumps of functions that have no conditional: atan2 at the negative half of its second axis, and
// x / |x| at 0.
#pragma once

#include "ir/module.h"

namespace pse::antialias {

// Puts a comparison that falls differently on both sides behind each, in the main function. Nothing
// uses what it gives. Returns these values.
std::vector<ir::Value> add_seams(ir::Module& module);

}  // namespace pse::antialias
