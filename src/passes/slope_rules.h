// The slope of each operator and of each function of the math library.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "passes/emit.h"

namespace pse::passes {

// The derivative of an operator's result along one direction, given those of its operands
// (no_value: 0). `in` must have an active operand and be no call, load or conditional.
ir::Value slope_of(const Emit& emit, const ir::Instruction& in,
                   const std::vector<ir::Value>& slopes);

// Whether partials_of knows this function.
bool has_partials(const std::string& name);

// The partial derivatives of a function of the math library, by its name; nothing for functions
// that are differentiated by their bodies. Their bodies take numbers apart bit by bit, which has no
// slope. `wanted` says by which arguments; the others are no_value.
std::optional<std::vector<ir::Value>> partials_of(const Emit& emit, const std::string& name,
                                                  const ir::Instruction& call,
                                                  const std::vector<bool>& wanted);

}  // namespace pse::passes
