// The first tier: a program's sample function as machine code within a millisecond or two, for
// processors with AVX2 and FMA. Code is written instruction by instruction, eight samples at a
// time, without optimisation beyond keeping values in registers while they last. All bits are those
// of the interpreter. From the SplitModule to bytes; first_kernel.cpp makes them a Kernel.
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <unordered_map>
#include <vector>

#include "codegen/array_layout.h"
#include "codegen/first/assembler.h"
#include "codegen/first/constants.h"
#include "passes/pipeline.h"

namespace pse::first {

inline constexpr int lanes = 8;

struct KernelCode {
  std::vector<std::uint8_t> bytes;  // the entry point is their start; constants stand at their end
  std::int64_t frame_floats = 0;    // memory it needs behind the arrays, in KernelCall::scratch
};

// The error says what the first tier does not do.
std::expected<KernelCode, std::string> write_kernel(const passes::SplitModule& split);

// How a function of the program is called: by rows of the frame.
struct Callee {
  Label entry;
  std::int32_t mask = 0, params = 0, results = 0;  // where they begin, in bytes from the frame
};

// What the functions of one kernel share while their code is written.
struct KernelState {
  explicit KernelState(const passes::SplitModule& s)
      : split(s),
        frame_arrays(s.module.main().arrays),
        sample_arrays(s.module.main().arrays, lanes) {}

  const passes::SplitModule& split;
  FrameArrayLayout frame_arrays;
  SampleArrayLayout sample_arrays;
  Assembler code;
  Constants constants;
  Label leave;                        // ends the run from anywhere
  std::int32_t frame_size = 0;        // rows given to functions so far, in bytes
  std::int32_t call_block = 0;        // rows through which the host's functions are called
  std::vector<std::int32_t> lengths;  // per array of rate sample: the row of its lengths
  std::unordered_map<std::uint32_t, Callee> callees;
  std::unordered_map<std::int32_t, Label> byte_lookups;  // by table
  std::unordered_map<std::int64_t, Memory> tables;       // by operator and table
  std::string refused;  // why there is no first tier; empty: there is
};

}  // namespace pse::first
