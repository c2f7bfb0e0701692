// Runs modules by the interpreter, whole or split, so that tests can compare what they give.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "ir/interpreter.h"
#include "passes/pipeline.h"

namespace pse::test {

struct RunResult {
  ir::End end = ir::End::finished;
  std::vector<ir::Bits> outputs;  // empty unless finished; NaN is the one NaN
  friend bool operator==(const RunResult&, const RunResult&) = default;
};

inline RunResult run_module(const ir::Module& module, std::span<const float> inputs,
                            const ir::ExternalCallback* external = nullptr) {
  ir::Interpreted run = ir::interpret(module, module.entry, inputs, external);
  if (run.outcome.end != ir::End::finished) run.results.clear();
  return {run.outcome.end, std::move(run.results)};
}

// Runs the frame function, then the program on one sample.
inline RunResult run_split(const passes::SplitModule& split, std::span<const float> inputs,
                           const ir::ExternalCallback* external = nullptr) {
  const ir::Module& module = split.module;
  ir::Interpreter interpreter(module);
  std::vector<float> uniforms(inputs.begin(), inputs.end());
  uniforms.resize(module.inputs.size());
  const ir::Function& frame = module.functions[split.frame];
  ir::ArrayMemory memory(frame);
  const ir::Environment environment{
      .inputs = uniforms, .arrays = memory.views(), .external = external};

  // The frame must not see what belongs to the sample.
  std::vector<float> frame_inputs = uniforms;
  for (std::size_t i = 0; i < frame_inputs.size(); ++i) {
    if (module.inputs[i].rate == ir::Rate::sample) frame_inputs[i] = -12345.0f;
  }
  ir::Environment frame_environment = environment;
  frame_environment.inputs = frame_inputs;
  std::vector<ir::Bits> slots(frame.body.yields.size());
  ir::Outcome outcome = interpreter.run(split.frame, {}, frame_environment, slots);
  if (outcome.end != ir::End::finished) return {outcome.end, {}};
  for (std::size_t i = 0; i < slots.size(); ++i)
    uniforms[split.first_slot + i] = ir::to_f32(slots[i]);

  RunResult result;
  result.outputs.resize(module.outputs.size());
  outcome = interpreter.run(module.entry, {}, environment, result.outputs);
  if (outcome.end != ir::End::finished) return {outcome.end, {}};
  for (ir::Bits& bits : result.outputs) bits = ir::canonical(bits);
  return result;
}

}  // namespace pse::test
