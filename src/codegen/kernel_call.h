// What the compiled code is given: one struct by pointer, whose field order the emitter knows
// (llvm/call_fields.h). Between stream/ and the machine code: compiled_kernel.cpp fills it, the
// code reads it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "codegen/kernel.h"

namespace pse {

// Calls a host's function for those of up to 64 lanes whose bit is set in `active`, and for no
// others: their results become 0. `lanes`: how many there are.
void call_active(void (*call)(void*, std::int64_t, const float* const*, float* const*), void* user,
                 std::uint64_t active, std::int64_t lanes, std::int64_t arguments,
                 const float* const* argument, std::int64_t results, float* const* result);

struct KernelCall {
  const float* const* inputs =
      nullptr;  // one array per Module::inputs entry, null unless of rate sample
  float* const* outputs =
      nullptr;             // samples: one array per output; frame: outputs[0] is the array of slots
  std::int64_t count = 0;  // samples; a multiple of the width
  const float* uniforms = nullptr;  // FrameState::uniforms
  float* frame_arrays =
      nullptr;  // laid out by FrameArrayLayout; written by the frame function only
  std::int32_t* frame_lengths = nullptr;  // one per Array
  float* scratch = nullptr;  // sample-rate arrays, laid out by SampleArrayLayout; 64-byte aligned
  const std::atomic<bool>* cancel = nullptr;
  const ExternalFunction* externals = nullptr;
  decltype(&pse::call_active) call_active = &pse::call_active;
  // Out: where a check failed, or -1. Written before the code returns early.
  std::int32_t failed_check = -1;
  std::int64_t failed_sample = 0;
};

// Both functions of a compiled module have this type. They return early when cancelled or when a
// check fails.
using KernelEntry = void (*)(KernelCall*);
inline constexpr const char* samples_symbol = "pse_samples";
inline constexpr const char* frame_symbol = "pse_frame";

static_assert(sizeof(std::atomic<bool>) == 1);
static_assert(sizeof(ExternalFunction) == 2 * sizeof(void*));

}  // namespace pse
