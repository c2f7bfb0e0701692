// Lays out arrays and slots as compiled code does, and runs one function.
#include "codegen/interpreted_frame.h"

#include "codegen/array_layout.h"

namespace pse {
namespace {

std::size_t floats_of(const ir::Array& array) {
  return static_cast<std::size_t>(array.components) * static_cast<std::size_t>(array.capacity);
}

}  // namespace

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
    if (sample != nullptr) sample += floats_of(arrays[i]);
  }
  return places;
}

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

void report_failure(RunStatus& status, std::int32_t check, std::uint32_t sample) {
  std::int32_t none = -1;
  if (status.failed_check.compare_exchange_strong(none, check)) status.failed_sample = sample;
}

bool interpret_frame(const passes::SplitModule& split, FrameState& state, RunStatus& status,
                     std::uint64_t max_turns, std::uint64_t* operations) {
  const ir::Module& module = split.module;
  const ir::Function& function = module.functions[split.frame];
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
                                    .cancel = &status.stop(),
                                    .max_turns = max_turns};
  std::vector<ir::Bits> slots(function.body.yields.size());
  ir::Interpreter interpreter(module);
  const ir::Outcome outcome = interpreter.run(split.frame, {}, environment, slots);
  if (operations) *operations = interpreter.operations();
  if (outcome.end == ir::End::out_of_turns) return false;
  // Slots keep their bits as they are: they may carry an integer.
  for (std::size_t i = 0; i < slots.size(); ++i)
    state.uniforms[split.first_slot + i] = ir::to_f32(slots[i]);
  if (outcome.end == ir::End::failed_check) report_failure(status, outcome.check, 0);
  return true;
}

}  // namespace pse
