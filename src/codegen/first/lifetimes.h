// How long each value of a function is needed, as positions in the order in which its code is
// written. From the IR to places.cpp, which gives registers and memory back by it.
#pragma once

#include <cstdint>
#include <vector>

#include "ir/module.h"

namespace pse::first {

// The writer of code numbers its steps: one for each instruction, before its regions, and one for
// the end of each region. Step n reads operands at time 2n and has results from time 2n + 1 on.
struct Lifetimes {
  explicit Lifetimes(const ir::Function& function);

  std::vector<std::int32_t> last_use;  // per value: the time after which it is not needed
  std::vector<ir::Value> order;        // values by last_use
};

}  // namespace pse::first
