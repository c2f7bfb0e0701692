// Machine code behind the Kernel interface.
// Made by compile.cpp; run by stream/.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "codegen/array_layout.h"
#include "codegen/code_object.h"
#include "codegen/frame_code.h"
#include "codegen/kernel.h"
#include "codegen/kernel_call.h"

namespace pse {

class CompiledKernel final : public Kernel {
 public:
  // Null where the object lacks an entry point. `own_floats`: memory that the code wants behind the
  // sample's arrays, in KernelCall::scratch.
  static std::unique_ptr<CompiledKernel> make(const passes::SplitModule& split, CodeObject code,
                                              int width, std::unique_ptr<const FrameCode> frame,
                                              std::size_t own_floats = 0);

  int width() const override { return width_; }
  void run_frame(FrameState& state, RunStatus& status) const override;
  void run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                   const float* const* inputs, float* const* outputs,
                   std::int64_t count) const override;
  // As the optimised tier's; the first tier's are counted by who holds its code.
  TierSamples tier_samples() const override { return {0, samples_run_}; }

 private:
  CompiledKernel(const passes::SplitModule& split, CodeObject code, int width,
                 std::unique_ptr<const FrameCode> frame, std::size_t own_floats);
  void run_tail(KernelCall call, RunStatus& status, float* buffers, std::int64_t first,
                std::int64_t count) const;

  CodeObject code_;
  std::unique_ptr<const FrameCode> frame_;
  int width_;
  std::vector<bool> is_sample_input_;
  std::size_t output_count_;
  SampleArrayLayout sample_layout_;
  std::size_t own_floats_;
  KernelEntry samples_ = nullptr;
  mutable std::atomic<std::int64_t> samples_run_{0};
};

}  // namespace pse
