// The bounds of the operators of ir/ops.h that have no regions and touch no arrays.
#pragma once

#include <span>

#include "bounds/values.h"

namespace pse::bounds {

// `in` is the instruction, `a` what its operands are, at least one of them not exact.
Bound bound_operator(const ir::Module& module, const ir::Instruction& in, std::span<const Bound> a);

}  // namespace pse::bounds
