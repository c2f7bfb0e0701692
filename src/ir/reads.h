// What a program reads of what the stream could bring.
#pragma once

#include <vector>

#include "ir/module.h"

namespace pse::ir {

// Marks the inputs that instructions of a region read; `read` has an entry for each input.
void mark_inputs_read(const Region& region, std::vector<bool>& read);

// For each input of a module, whether any of its functions reads it. Passes leave inputs that
// nothing reads any more, so that the others keep their numbers.
std::vector<bool> inputs_read(const Module& module);

}  // namespace pse::ir
