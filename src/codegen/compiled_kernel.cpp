// Prepares the KernelCall, and runs what is left over when the samples do not fill the last vector.
#include "codegen/compiled_kernel.h"

#include <algorithm>
#include <bit>

namespace pse {
namespace {

float* aligned(float* memory) {
  const auto address = std::bit_cast<std::uintptr_t>(memory);
  return memory + ((64 - address % 64) % 64) / sizeof(float);
}

}  // namespace

std::unique_ptr<CompiledKernel> CompiledKernel::make(const passes::SplitModule& split,
                                                     CodeObject code, int width,
                                                     std::unique_ptr<const FrameCode> frame,
                                                     std::size_t own_floats) {
  std::unique_ptr<CompiledKernel> kernel(
      new CompiledKernel(split, std::move(code), width, std::move(frame), own_floats));
  return kernel->samples_ ? std::move(kernel) : nullptr;
}

CompiledKernel::CompiledKernel(const passes::SplitModule& split, CodeObject code, int width,
                               std::unique_ptr<const FrameCode> frame, std::size_t own_floats)
    : code_(std::move(code)),
      frame_(std::move(frame)),
      width_(width),
      output_count_(split.module.outputs.size()),
      sample_layout_(split.module.main().arrays, width),
      own_floats_(own_floats) {
  for (const ir::Input& input : split.module.inputs)
    is_sample_input_.push_back(input.rate == ir::Rate::sample);
  samples_ = reinterpret_cast<KernelEntry>(const_cast<void*>(code_.find(samples_symbol)));
}

void CompiledKernel::run_frame(FrameState& state, RunStatus& status) const {
  frame_->run(state, status);
}

void CompiledKernel::run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                                 const float* const* inputs, float* const* outputs,
                                 std::int64_t count) const {
  samples_run_.fetch_add(count, std::memory_order_relaxed);

  // Scratch: the arrays of a vector of samples, what the code wants for itself, then buffers for
  // the last, partly filled vector.
  const auto width = static_cast<std::size_t>(width_);
  const auto arrays = static_cast<std::size_t>(sample_layout_.size) + own_floats_;
  const std::size_t needed = arrays + width * (is_sample_input_.size() + output_count_) + 16;
  if (scratch.memory.size() < needed) scratch.memory.resize(needed);

  KernelCall call;
  call.inputs = inputs;
  call.outputs = outputs;
  call.count = count / width_ * width_;
  call.uniforms = state.uniforms.data();
  // The sample function only reads what belongs to the frame.
  call.frame_arrays = const_cast<float*>(state.arrays.data());
  call.frame_lengths = const_cast<std::int32_t*>(state.array_lengths.data());
  call.scratch = aligned(scratch.memory.data());
  call.cancel = &status.stop();
  call.externals = state.externals.data();
  if (call.count > 0) samples_(&call);
  report(call, status, 0);
  if (call.count < count && call.failed_check < 0 && !status.stopped()) {
    run_tail(call, status, call.scratch + arrays, call.count, count - call.count);
  }
}

// The last vector repeats the last sample in its spare lanes: they do only what a real lane does as
// well.
void CompiledKernel::run_tail(KernelCall call, RunStatus& status, float* buffers,
                              std::int64_t first, std::int64_t count) const {
  std::vector<const float*> inputs(is_sample_input_.size());
  std::vector<float*> outputs(output_count_);
  float* next = buffers;
  for (std::size_t i = 0; i < inputs.size(); ++i, next += width_) {
    if (!is_sample_input_[i] || !call.inputs[i]) continue;
    for (std::int64_t lane = 0; lane < width_; ++lane)
      next[lane] = call.inputs[i][first + std::min(lane, count - 1)];
    inputs[i] = next;
  }
  for (std::size_t i = 0; i < outputs.size(); ++i, next += width_) outputs[i] = next;
  float* const* wanted = call.outputs;
  call.inputs = inputs.data();
  call.outputs = outputs.data();
  call.count = width_;
  samples_(&call);
  report(call, status, first);
  for (std::size_t i = 0; i < outputs.size(); ++i)
    std::copy_n(outputs[i], count, wanted[i] + first);
}

}  // namespace pse
