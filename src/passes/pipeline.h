// The compiler's middle: IR -> IR. pipeline.cpp is the table of contents.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/call_range.h"
#include "ir/module.h"

namespace pse::passes {

// A module cut by rate. functions[frame] runs once per frame: it has no parameters, reads only
// frame-rate inputs, may write arrays of rate frame, and yields one f32 per frame slot.
// functions[module.entry] runs per sample and reads slot k as `input (first_slot + k)`:
// module.inputs ends with one frame-rate Input "$slot.k" per slot. i32 travels by bits2f/f2bits,
// boolean as 1 or 0; so a slot keeps its bits as they are, also where they look like a NaN's. Both
// functions' `arrays` lists are the same, index for index; arrays of rate frame are written only by
// the frame function, arrays of rate sample are touched only by the sample function.
struct SplitModule {
  ir::Module module;
  std::uint32_t frame = 0;       // function index
  std::uint32_t first_slot = 0;  // input index
};

// When the copies of a called function become one function again (outline.cpp); in instructions.
struct OutlineOptions {
  std::size_t min_total = 900;  // of the program
  std::size_t min_size = 60;    // of a copy
  std::size_t min_saved = 150;  // of all copies but one
  std::size_t max_parameters = 24, max_results = 16;
  std::size_t max_function = 1500;  // larger ones lose calls, of at least min_cut
  std::size_t min_cut = 250;
};

struct PipelineOptions {
  bool optimize = true;  // off: only what correctness needs (rates, split)
  // The calls that were written into the entry function; none: copies stay as they are.
  std::vector<ir::CallRange> calls;
  OutlineOptions outline;
  // Called after each pass with its name and the module, for --emit and tests.
  std::function<void(std::string_view pass, const ir::Module&)> after_pass;
};

SplitModule run_pipeline(ir::Module module, const PipelineOptions& options = {});

}  // namespace pse::passes
