// The interpreter behind the kernel's interface: one sample at a time, and nothing compiled.
#include <algorithm>
#include <utility>

#include "codegen/array_layout.h"
#include "codegen/kernel.h"
#include "ir/interpreter.h"

namespace pse {
namespace {

// Whose array memory a run uses: the frame's for arrays of rate frame, the sample's own for the
// others.
struct ArrayPlaces {
  std::vector<ir::ArrayView> views;
  std::vector<std::int32_t> sample_lengths;
};

std::size_t floats_of(const ir::Array& array) {
  return static_cast<std::size_t>(array.components) * static_cast<std::size_t>(array.capacity);
}

// Floats that the arrays of rate sample take, one after another as planes.
std::size_t sample_size(const std::vector<ir::Array>& arrays) {
  std::size_t size = 0;
  for (const ir::Array& array : arrays)
    size += array.rate == ir::Rate::sample ? floats_of(array) : 0;
  return size;
}

ArrayPlaces place_arrays(const std::vector<ir::Array>& arrays, float* frame,
                         std::int32_t* frame_lengths, float* sample) {
  const FrameArrayLayout layout(arrays);
  ArrayPlaces places;
  places.sample_lengths.resize(arrays.size());
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (arrays[i].rate != ir::Rate::sample) {
      places.views.push_back({frame + layout.offset[i], &frame_lengths[i]});
      continue;
    }
    places.views.push_back({sample, &places.sample_lengths[i]});
    sample += floats_of(arrays[i]);
  }
  return places;
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

// The host's functions, called for one sample.
ir::ExternalCallback external_caller(const FrameState& state) {
  return
      [&state](std::uint32_t external, std::span<const float> arguments, std::span<float> results) {
        std::vector<const float*> argument_places;
        std::vector<float*> result_places;
        for (const float& argument : arguments) argument_places.push_back(&argument);
        for (float& result : results) result_places.push_back(&result);
        const ExternalFunction& function = state.externals[external];
        function.call(function.user, 1, argument_places.data(), result_places.data());
      };
}

class InterpretedKernel final : public Kernel {
 public:
  explicit InterpretedKernel(std::shared_ptr<const passes::SplitModule> split,
                             OperationCounter* counter = nullptr)
      : split_(std::move(split)), counter_(counter) {}

  int width() const override { return 1; }

  void run_frame(FrameState& state, RunStatus& status) const override {
    const ir::Module& module = split_->module;
    const ir::Function& function = module.functions[split_->frame];
    state.uniforms.resize(module.inputs.size());
    state.arrays.assign(static_cast<std::size_t>(FrameArrayLayout(function.arrays).size), 0.0f);
    state.array_lengths.clear();
    for (const ir::Array& array : function.arrays)
      state.array_lengths.push_back(array.initial_length);

    const ArrayPlaces places =
        place_arrays(function.arrays, state.arrays.data(), state.array_lengths.data(), nullptr);
    const ir::ExternalCallback external = external_caller(state);
    const ir::Environment environment{.inputs = state.uniforms,
                                      .arrays = places.views,
                                      .external = &external,
                                      .cancel = &status.cancel};
    std::vector<ir::Bits> slots(function.body.yields.size());
    ir::Interpreter interpreter(module);
    const ir::Outcome outcome = interpreter.run(split_->frame, {}, environment, slots);
    if (counter_ != nullptr) counter_->frame += interpreter.operations();
    // Slots keep their bits as they are: they may carry an integer.
    for (std::size_t i = 0; i < slots.size(); ++i)
      state.uniforms[split_->first_slot + i] = ir::to_f32(slots[i]);
    if (outcome.end == ir::End::failed_check) fail(status, outcome.check, 0);
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
                                      .cancel = &status.cancel};
    ir::Interpreter interpreter(module);
    std::vector<ir::Bits> results(module.outputs.size());
    for (std::int64_t sample = 0; sample < count; ++sample) {
      // Samples do not end by themselves where nothing loops, so the flag is polled here too.
      if (status.cancel.load(std::memory_order_relaxed)) return;
      for (std::size_t i = 0; i < module.inputs.size(); ++i) {
        if (module.inputs[i].rate == ir::Rate::sample && inputs[i]) uniforms[i] = inputs[i][sample];
      }
      begin_sample(arrays, places);

      const ir::Outcome outcome = interpreter.run(module.entry, {}, environment, results);
      if (counter_ != nullptr) counter_->sample += interpreter.operations();
      if (outcome.end == ir::End::failed_check)
        fail(status, outcome.check, static_cast<std::uint32_t>(sample));
      if (outcome.end != ir::End::finished) return;
      for (std::size_t i = 0; i < results.size(); ++i)
        outputs[i][sample] = ir::to_f32(ir::canonical(results[i]));
    }
  }

 private:
  // The first failure of a run is the one reported.
  static void fail(RunStatus& status, std::int32_t check, std::uint32_t sample) {
    std::int32_t none = -1;
    if (status.failed_check.compare_exchange_strong(none, check)) status.failed_sample = sample;
  }

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
