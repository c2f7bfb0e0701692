// See run_program.h.
#include "support/run_program.h"

#include <stdexcept>

namespace pse::test {

std::string Outcome::messages() const {
  std::string text;
  for (const Diagnostic& d : diagnostics.all()) {
    const std::string line = d.span.valid() ? std::to_string(sources.position(d.span).line) : "?";
    text += line + ":" + d.code + ": " + d.message +
            (d.suggestion.empty() ? "" : " (" + d.suggestion + ")") + "\n";
  }
  return text;
}

float Outcome::number(const std::string& name) const {
  const auto found = values.find(name);
  if (found == values.end() || found->second.size() != 1)
    throw std::runtime_error("no number `" + name + "`: " + messages() + failed_check);
  return found->second.front();
}

Outcome run_program(const std::string& text, const Sample& sample, const RunSettings& settings) {
  Outcome outcome;
  CompileOptions options;
  options.interpret = settings.interpret;
  options.optimize = settings.optimize;
  options.codegen.width = settings.width;
  for (const auto& [name, value] : sample.stream)
    options.lower.stream.push_back({name, static_cast<int>(value.size()), ir::Rate::sample});
  for (const auto& [name, value] : sample.frame)
    options.lower.stream.push_back({name, static_cast<int>(value.size()), ir::Rate::frame});
  LowerHost host;
  host.find_module = [&](SourceMap& sources, const std::string& name) -> std::optional<FileId> {
    const auto found = settings.modules.find(name);
    if (found == settings.modules.end()) return {};
    return sources.add(name + ".pse", found->second);
  };
  const FileId file = outcome.sources.add("test.pse", text);
  outcome.program = compile(outcome.sources, file, host, options, outcome.diagnostics);
  if (!outcome.program) return outcome;
  outcome.compiled = true;

  // One sample in arrays of sixteen; its values come from the maps by input name.
  const ir::Module& module = outcome.program->module();
  constexpr std::size_t padded = 16;
  const auto value_of = [&](const std::string& input) -> float {
    for (const auto* names : {&sample.stream, &sample.frame, &sample.knobs})
      for (const auto& [name, value] : *names)
        for (std::size_t c = 0; c < value.size(); ++c)
          if (input == (value.size() == 1 ? name : name + "." + std::to_string(c))) return value[c];
    for (const Knob& knob : outcome.program->knobs)
      for (std::size_t c = 0; c < knob.value.size(); ++c)
        if (input == (knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(c)))
          return knob.value[c];
    return 0;
  };
  FrameState state;
  std::vector<std::vector<float>> inputs(module.inputs.size()), outputs(module.outputs.size());
  std::vector<const float*> input_pointers;
  std::vector<float*> output_pointers;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    state.uniforms.push_back(value_of(module.inputs[i].name));
    inputs[i].assign(padded, state.uniforms.back());
    input_pointers.push_back(inputs[i].data());
  }
  for (auto& output : outputs) {
    output.assign(padded, 0);
    output_pointers.push_back(output.data());
  }
  RunStatus status;
  Scratch scratch;
  outcome.program->kernel->run_frame(state, status);
  if (status.failed_check < 0)
    outcome.program->kernel->run_samples(state, status, scratch, input_pointers.data(),
                                         output_pointers.data(), 1);
  if (status.failed_check >= 0) {
    const ir::Check& check = module.checks[static_cast<std::size_t>(status.failed_check.load())];
    outcome.failed_check =
        std::to_string(outcome.sources.position(check.span).line) + ": " + check.message;
  }
  std::size_t next = 0;
  for (const ProgramOutput& output : outcome.program->outputs)
    for (int c = 0; c < output.components; ++c)
      outcome.values[output.name].push_back(outputs[next++].front());
  return outcome;
}

}  // namespace pse::test
