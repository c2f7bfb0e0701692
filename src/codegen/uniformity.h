// Which values are the same for all samples of a vector: those stay scalar in the code.
// First step of both emitters; needs no LLVM.
#pragma once

#include <vector>

#include "ir/module.h"
#include "passes/pipeline.h"

namespace pse {

struct Uniformity {
  std::vector<bool>
      varying;  // per Value: differs between samples that are active where it is visible
  std::vector<bool> varying_length;  // per Array of rate sample: its length differs between samples
};

// `varying_params` says which of the function's parameters differ between samples.
Uniformity find_uniformity(const ir::Module& module, const ir::Function& function,
                           const std::vector<bool>& varying_params);

// Whether samples of one vector may leave a loop at different turns.
bool has_varying_loops(const passes::SplitModule& split);

// One sample per vector: nothing varies.
Uniformity all_uniform(const ir::Function& function);

}  // namespace pse
