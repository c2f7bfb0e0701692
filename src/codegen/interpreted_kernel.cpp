// The interpreter behind the kernel's interface: one sample at a time, and nothing compiled.
#include <algorithm>
#include <utility>

#include "codegen/interpreted_frame.h"

namespace pse {
namespace {

// Floats that the arrays of rate sample take, one after another as planes.
std::size_t sample_size(const std::vector<ir::Array>& arrays) {
  std::size_t size = 0;
  for (const ir::Array& array : arrays) {
    if (array.rate == ir::Rate::sample)
      size += static_cast<std::size_t>(array.components) * static_cast<std::size_t>(array.capacity);
  }
  return size;
}

// Sample-rate arrays as each sample finds them. Elements past the length are never seen before they
// are set to 0.
void begin_sample(const std::vector<ir::Array>& arrays, ArrayPlaces& places) {
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (arrays[i].rate != ir::Rate::sample) continue;
    places.sample_lengths[i] = arrays[i].initial_length;
    for (std::int32_t c = 0; c < arrays[i].components; ++c) {
      std::fill_n(places.views[i].planes + std::ptrdiff_t{c} * arrays[i].capacity,
                  arrays[i].initial_length, 0.0f);
    }
  }
}

class InterpretedKernel final : public Kernel {
 public:
  explicit InterpretedKernel(std::shared_ptr<const passes::SplitModule> split,
                             OperationCounter* counter = nullptr)
      : split_(std::move(split)), counter_(counter) {}

  int width() const override { return 1; }

  void run_frame(FrameState& state, RunStatus& status) const override {
    std::uint64_t operations = 0;
    interpret_frame(*split_, state, status, no_limit, &operations);
    if (counter_ != nullptr) counter_->frame += operations;
  }

  void run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                   const float* const* inputs, float* const* outputs,
                   std::int64_t count) const override {
    const ir::Module& module = split_->module;
    const std::vector<ir::Array>& arrays = module.main().arrays;
    scratch.memory.resize(sample_size(arrays));
    std::vector<std::int32_t> frame_lengths = state.array_lengths;
    frame_lengths.resize(arrays.size());
    // The program only reads the frame's arrays, through the same type of view as its own.
    float* frame_arrays = const_cast<float*>(state.arrays.data());
    ArrayPlaces places =
        place_arrays(arrays, frame_arrays, frame_lengths.data(), scratch.memory.data());

    const ir::ExternalCallback external = external_caller(state);
    std::vector<float> uniforms = state.uniforms;
    const ir::Environment environment{.inputs = uniforms,
                                      .arrays = places.views,
                                      .external = &external,
                                      .cancel = &status.stop()};
    ir::Interpreter interpreter(module);
    std::vector<ir::Bits> results(module.outputs.size());
    for (std::int64_t sample = 0; sample < count; ++sample) {
      // Samples do not end by themselves where nothing loops, so the flag is polled here too.
      if (status.stopped()) return;
      for (std::size_t i = 0; i < module.inputs.size(); ++i) {
        if (module.inputs[i].rate == ir::Rate::sample && inputs[i]) uniforms[i] = inputs[i][sample];
      }
      begin_sample(arrays, places);

      const ir::Outcome outcome = interpreter.run(module.entry, {}, environment, results);
      if (counter_ != nullptr) counter_->sample += interpreter.operations();
      if (outcome.end == ir::End::failed_check)
        report_failure(status, outcome.check, static_cast<std::uint32_t>(sample));
      if (outcome.end != ir::End::finished) return;
      for (std::size_t i = 0; i < results.size(); ++i)
        outputs[i][sample] = ir::to_f32(ir::canonical(results[i]));
    }
  }

 private:
  std::shared_ptr<const passes::SplitModule> split_;
  OperationCounter* counter_;
};

}  // namespace

std::unique_ptr<Kernel> make_interpreted_kernel(std::shared_ptr<const passes::SplitModule> split) {
  return std::make_unique<InterpretedKernel>(std::move(split));
}

std::unique_ptr<Kernel> make_counting_kernel(std::shared_ptr<const passes::SplitModule> split,
                                             OperationCounter& counter) {
  return std::make_unique<InterpretedKernel>(std::move(split), &counter);
}

}  // namespace pse
