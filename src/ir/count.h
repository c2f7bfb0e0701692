// How large a program is: instructions in all, and operations by rate (`--stats`).
#pragma once

#include <array>
#include <cstddef>

#include "ir/module.h"

namespace pse::ir {

std::size_t count_instructions(const Region& region);
std::size_t count_instructions(const Function& function);
std::size_t count_instructions(const Module& module);
// Those of one operator.
std::size_t count_instructions(const Region& region, Op op);

// Operations by Rate, constants and inputs not counted. An instruction has the rate of its results;
// one without results has that of its operands.
using RateCounts = std::array<std::size_t, 3>;
RateCounts count_by_rate(const Function& function);

}  // namespace pse::ir
