// Says what is wrong with a module: types, dominance, shapes of regions, indices, the call graph.
// Every pass must give a module without complaints; the interpreter and the emitters rely on it.
#pragma once

#include <string>
#include <vector>

#include "ir/module.h"

namespace pse::ir {

// One sentence per complaint, the first hundred of them; empty for a valid module.
std::vector<std::string> verify(const Module& module);

}  // namespace pse::ir
