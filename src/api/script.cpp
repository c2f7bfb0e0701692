// The public Script: the compiler's pieces behind arrays of the caller's.
#include "pse/script.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "stream/program.h"

namespace pse {

struct Script::State {
  SourceMap sources;
  std::shared_ptr<const Program> program;
  std::vector<ScriptName> outputs;
  std::vector<ScriptKnob> knobs;
  std::vector<ScriptInput> inputs;
};

namespace {

// Samples run at a time: their arrays fit the nearer caches.
constexpr std::int64_t batch = 4096;

std::optional<FileId> find_module(SourceMap& sources, const std::vector<std::string>& path,
                                  const std::string& name) {
  for (const std::string& folder : path) {
    const std::filesystem::path file = std::filesystem::path(folder) / (name + ".pse");
    if (std::ifstream stream(file, std::ios::binary); stream) {
      std::ostringstream text;
      text << stream.rdbuf();
      return sources.add(file.string(), text.str());
    }
  }
  return {};
}

std::string input_name(const std::string& name, std::size_t components, std::size_t component) {
  return components == 1 ? name : name + "." + std::to_string(component);
}

}  // namespace

std::expected<Script, std::string> Script::compile(std::string_view text,
                                                   const ScriptOptions& options) {
  auto state = std::make_shared<State>();
  CompileOptions compile_options;
  compile_options.interpret = options.interpret;
  compile_options.codegen.cache = options.cache_folder;
  for (const ScriptInput& input : options.inputs)
    compile_options.lower.stream.push_back(
        {input.name, input.components, input.per_run ? ir::Rate::frame : ir::Rate::sample});
  LowerHost host;
  host.find_module = [&](SourceMap& sources, const std::string& name) {
    return pse::find_module(sources, options.module_path, name);
  };

  Diagnostics diagnostics;
  const FileId file = state->sources.add("<text>", std::string(text));
  state->program = pse::compile(state->sources, file, host, compile_options, diagnostics);
  if (!state->program) {
    diagnostics.sort();
    return std::unexpected(print_text(diagnostics, state->sources, false));
  }
  if (!state->program->module().externals.empty())
    return std::unexpected("the program looks up images, which a Script cannot bring yet");
  for (const ProgramOutput& output : state->program->outputs)
    state->outputs.push_back({output.name, output.components});
  Script script;
  for (const Knob& knob : state->program->knobs) {
    state->knobs.push_back({knob.name, knob.value, knob.text, knob.help});
    script.values_.push_back(knob.value);
  }
  state->inputs = options.inputs;
  script.state_ = std::move(state);
  return script;
}

const std::vector<ScriptName>& Script::outputs() const { return state_->outputs; }
const std::vector<ScriptKnob>& Script::knobs() const { return state_->knobs; }
const std::vector<std::string>& Script::reads() const { return state_->program->reads; }

std::expected<void, std::string> Script::set(std::string_view knob, std::span<const float> value) {
  for (std::size_t i = 0; i < state_->knobs.size(); ++i) {
    if (state_->knobs[i].name != knob) continue;
    if (value.size() != values_[i].size())
      return std::unexpected("knob `" + std::string(knob) + "` has " +
                             std::to_string(values_[i].size()) + " components, this gives " +
                             std::to_string(value.size()));
    values_[i].assign(value.begin(), value.end());
    return {};
  }
  return std::unexpected("the program has no knob `" + std::string(knob) + "`");
}

std::expected<void, std::string> Script::run(std::int64_t count,
                                             const std::vector<ConstArrays>& inputs,
                                             const std::vector<Arrays>& outputs) const {
  const Program& program = *state_->program;
  const ir::Module& module = program.module();

  // Where each input of the module comes from: an array of the caller, or a knob.
  std::map<std::string, const float*> arrays, uniforms;
  for (const ScriptInput& declared : state_->inputs) {
    const auto given = std::find_if(inputs.begin(), inputs.end(),
                                    [&](const ConstArrays& a) { return a.name == declared.name; });
    const bool read = std::find(reads().begin(), reads().end(), declared.name) != reads().end();
    if (given == inputs.end()) {
      if (read) return std::unexpected("input `" + declared.name + "` is read and not given");
      continue;
    }
    if (given->components.size() != static_cast<std::size_t>(declared.components))
      return std::unexpected("input `" + declared.name + "` was declared with " +
                             std::to_string(declared.components) + " components");
    for (std::size_t c = 0; c < given->components.size(); ++c)
      (declared.per_run ? uniforms
                        : arrays)[input_name(declared.name, given->components.size(), c)] =
          given->components[c];
  }
  for (std::size_t k = 0; k < values_.size(); ++k)
    for (std::size_t c = 0; c < values_[k].size(); ++c)
      uniforms[input_name(state_->knobs[k].name, values_[k].size(), c)] = &values_[k][c];

  // Where each output goes.
  std::map<std::string, float*> wanted;
  for (const Arrays& output : outputs) {
    const auto known =
        std::find_if(state_->outputs.begin(), state_->outputs.end(),
                     [&](const ScriptName& name) { return name.name == output.name; });
    if (known == state_->outputs.end())
      return std::unexpected("the program does not set `" + output.name + "`");
    if (output.components.size() != static_cast<std::size_t>(known->components))
      return std::unexpected("output `" + output.name + "` has " +
                             std::to_string(known->components) + " components");
    for (std::size_t c = 0; c < output.components.size(); ++c)
      wanted[input_name(output.name, output.components.size(), c)] = output.components[c];
  }

  // Run batch by batch through padded arrays of our own.
  FrameState frame;
  std::vector<std::vector<float>> in(module.inputs.size()), out(module.outputs.size());
  std::vector<const float*> in_pointers(module.inputs.size());
  std::vector<float*> out_pointers;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    const auto uniform = uniforms.find(module.inputs[i].name);
    frame.uniforms.push_back(uniform == uniforms.end() ? 0.0f : *uniform->second);
    if (module.inputs[i].rate == ir::Rate::sample) in[i].resize(batch);
    in_pointers[i] = in[i].empty() ? nullptr : in[i].data();
  }
  for (auto& plane : out) {
    plane.resize(batch);
    out_pointers.push_back(plane.data());
  }
  RunStatus status;
  Scratch scratch;
  program.kernel->run_frame(frame, status);
  for (std::int64_t first = 0; first < count && status.failed_check < 0; first += batch) {
    const std::int64_t here = std::min(batch, count - first);
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in_pointers[i]) std::copy_n(arrays.at(module.inputs[i].name) + first, here, in[i].data());
    program.kernel->run_samples(frame, status, scratch, in_pointers.data(), out_pointers.data(),
                                here);
    for (std::size_t o = 0; o < out.size(); ++o)
      if (const auto target = wanted.find(module.outputs[o].name); target != wanted.end())
        std::copy_n(out[o].data(), here, target->second + first);
  }
  if (const std::int32_t failed = status.failed_check; failed >= 0) {
    const ir::Check& check = module.checks[static_cast<std::size_t>(failed)];
    return std::unexpected(state_->sources.describe(check.span) + ": " + check.message);
  }
  return {};
}

}  // namespace pse
