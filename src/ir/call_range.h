// Where a call of a function of the language stands in the IR, although it has been written into
// its caller: what it became. From lower/ to the pass that makes repeated calls functions again.
#pragma once

#include "ir/module.h"

namespace pse::ir {

// The call's instructions are those that define the values [first, end) of the entry function.
struct CallRange {
  std::uint32_t callee = 0;  // equal for calls of the same function
  Value first = 0, end = 0;
};

}  // namespace pse::ir
