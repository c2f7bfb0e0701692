// The interpreter's view of a kernel's memory, and the frame function run by it. Shared by the
// interpreted kernel and by compiled ones, whose frame functions are seldom worth compiling.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "codegen/kernel.h"
#include "ir/interpreter.h"

namespace pse {

// Whose array memory a run uses: the frame's for arrays of rate frame, the sample's own for the
// others.
struct ArrayPlaces {
  std::vector<ir::ArrayView> views;
  std::vector<std::int32_t> sample_lengths;
};
ArrayPlaces place_arrays(const std::vector<ir::Array>& arrays, float* frame,
                         std::int32_t* frame_lengths, float* sample);

// The host's functions, called for one sample.
ir::ExternalCallback external_caller(const FrameState& state);

// The first failure of a run is the one reported.
void report_failure(RunStatus& status, std::int32_t check, std::uint32_t sample);

// Kernel::run_frame. False where loops turned more than `max_turns` times; the state then holds
// nothing of use. `operations` counts what was carried out.
inline constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();
bool interpret_frame(const passes::SplitModule& split, FrameState& state, RunStatus& status,
                     std::uint64_t max_turns = no_limit, std::uint64_t* operations = nullptr);

}  // namespace pse
