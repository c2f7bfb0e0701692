// Where the arrays of a program lie in memory: frame-rate arrays as planes, sample-rate arrays lane
// by lane. Shared by the interpreter, the compiled kernel and the emitter.
#pragma once

#include <cstdint>
#include <vector>

#include "ir/module.h"

namespace pse {

// FrameState::arrays: each array of rate frame as `components` planes of `capacity` floats, one
// array after another.
struct FrameArrayLayout {
  explicit FrameArrayLayout(const std::vector<ir::Array>& arrays);
  std::vector<std::int64_t> offset;  // one per Array, in floats; -1 where the rate is sample
  std::int64_t size = 0;

  std::int64_t plane(const std::vector<ir::Array>& arrays, std::size_t array,
                     std::int32_t component) const {
    return offset[array] + std::int64_t{component} * arrays[array].capacity;
  }
};

// Scratch memory of one vector of samples: [array][element][component][lane]. Each array has one
// element more than its capacity, where stores that fall outside go.
struct SampleArrayLayout {
  SampleArrayLayout(const std::vector<ir::Array>& arrays, int width);
  std::vector<std::int64_t> offset;  // one per Array, in floats; -1 where the rate is not sample
  std::int64_t size = 0;
};

}  // namespace pse
