// Which values of a program depend on the place, so that they have bounds instead of a value.
#pragma once

#include <vector>

#include "ir/module.h"

namespace pse::bounds {

struct Dependence {
  std::vector<bool> values;  // per value of the function
  // Per array: some element depends on the place, or on which places were written.
  std::vector<bool> arrays;
};

// Of the entry function; inputs of sample rate depend on the place.
Dependence find_dependence(const ir::Module& module);

}  // namespace pse::bounds
