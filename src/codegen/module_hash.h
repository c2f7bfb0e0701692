// The content of a program as a hash: what decides the machine code, and nothing else (no names, no
// places in text). The cache's key.
#pragma once

#include "base/hash.h"
#include "passes/pipeline.h"

namespace pse {

void hash_program(Hasher& hasher, const passes::SplitModule& split);

}  // namespace pse
