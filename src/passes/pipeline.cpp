// The compiler's middle as a table of contents.
#include "passes/pipeline.h"

#include <utility>

namespace pse::passes {

SplitModule run_pipeline(ir::Module module, const PipelineOptions& options) {
  SplitModule split;
  split.first_slot = static_cast<std::uint32_t>(module.inputs.size());
  split.frame = static_cast<std::uint32_t>(module.functions.size());
  ir::Function frame;
  frame.name = "frame";
  frame.arrays = module.main().arrays;
  module.functions.push_back(std::move(frame));
  split.module = std::move(module);
  if (options.after_pass) options.after_pass("split", split.module);
  return split;
}

}  // namespace pse::passes
