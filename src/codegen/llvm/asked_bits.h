// Which bits of each value anybody looks at: what nobody looks at may hold anything, and some
// operators are cheaper then. Needs no LLVM.
#pragma once

#include <cstdint>
#include <vector>

#include "ir/module.h"

namespace pse {

// Per Value of the function: the bits that some use of it depends on. Exact through tables, shifts
// and masks by constants, and selects; every other use asks for all 32.
std::vector<std::uint32_t> find_asked_bits(const ir::Module& module, const ir::Function& function);

}  // namespace pse
