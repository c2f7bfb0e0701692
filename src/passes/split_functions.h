// The two halves of split.cpp. Both need the program's rates.
#pragma once

#include <cstddef>
#include <vector>

#include "ir/module.h"

namespace pse::passes {

// The program without the frame's work. Its value candidates[k], where it is still used, is `input
// (first_slot + k)`.
struct SampleFunction {
  ir::Function function;
  std::vector<ir::Value> candidates;
};
SampleFunction cut_sample_function(const ir::Function& program, std::size_t first_slot);

// The program's work of rate frame; yields these values of it, one float each.
ir::Function cut_frame_function(const ir::Function& program, const std::vector<ir::Value>& slots);

}  // namespace pse::passes
