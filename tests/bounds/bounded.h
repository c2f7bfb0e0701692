// A program and the program of its bounds, from text, run at places and over boxes.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "bounds/bounds.h"
#include "diag/diagnostics.h"
#include "ir/verifier.h"
#include "stream/program.h"

namespace pse::bounds::test {

using Place = std::array<float, 3>;

class Bounded {
 public:
  // The program reads `point`, or x, y and z as its components, and sets `output`.
  explicit Bounded(const std::string& text, const std::string& output = "c", bool interpret = true,
                   const LowerHost& host = {}) {
    plain_ = make(text, output, interpret, host, false);
    bounds_ = make(text, output, interpret, host, true);
  }

  // The first output at places.
  std::vector<float> at(const std::vector<Place>& places) const {
    return run(*plain_, places, places).front();
  }
  struct Ends {
    std::vector<float> lo, hi;
  };
  // Its bounds over boxes between two corners.
  Ends over(const std::vector<Place>& low, const std::vector<Place>& high) const {
    auto ends = run(*bounds_, low, high);
    return {ends[0], ends[1]};
  }
  std::array<float, 2> over(const Place& low, const Place& high) const {
    const Ends ends = over(std::vector{low}, std::vector{high});
    return {ends.lo.front(), ends.hi.front()};
  }

 private:
  static std::shared_ptr<const Program> make(const std::string& text, const std::string& output,
                                             bool interpret, const LowerHost& host, bool bounded) {
    CompileOptions options;
    options.lower.stream = {{"point", 3}, {"x", 1}, {"y", 1}, {"z", 1}};
    options.lower.stream.push_back({"xform", 16, ir::Rate::frame});
    for (const char* name : {"frame", "time", "fps", "width", "height", "pixelsize", "pixel_freq",
                             "seed", "begin_frame", "prepass.step"})
      options.lower.stream.push_back({name, 1, ir::Rate::frame});
    for (const char* name : {"u", "v", "px", "py", "prepass.near", "prepass.far"})
      options.lower.stream.push_back({name, 1});
    options.lower.outputs = {output};
    options.interpret = interpret;
    SourceMap sources;
    Diagnostics diagnostics;
    auto front = compile_front(sources, sources.add("test.pse", text), host, options, diagnostics);
    if (!front) throw std::runtime_error(print_text(diagnostics, sources, false));
    front->calls.clear();
    if (bounded) bound_outputs(front->module);
    for (const std::string& complaint : ir::verify(front->module)) ADD_FAILURE() << complaint;
    auto made = compile_back(std::move(*front), options);
    if (!made) throw std::runtime_error(made.error());
    return *made;
  }

  static std::vector<std::vector<float>> run(const Program& program, const std::vector<Place>& low,
                                             const std::vector<Place>& high) {
    const ir::Module& module = program.module();
    const std::size_t room = (low.size() + 15) / 16 * 16;
    std::vector<std::vector<float>> inputs,
        outputs(module.outputs.size(), std::vector<float>(room));
    FrameState state;
    for (const ir::Input& input : module.inputs) {
      const std::string& name = input.name;
      const std::string base = name.substr(0, name.find('$'));
      const int axis = base == "x" || base == "point.0"   ? 0
                       : base == "y" || base == "point.1" ? 1
                       : base == "z" || base == "point.2" ? 2
                                                          : -1;
      const auto& places = name.ends_with("$hi") ? high : low;
      inputs.emplace_back(room, 0.0f);
      if (axis >= 0)
        for (std::size_t i = 0; i < places.size(); ++i)
          inputs.back()[i] = places[i][static_cast<std::size_t>(axis)];
      const float value = base == "width" || base == "height" ? 512.0f
                          : base == "pixelsize"               ? 2.0f / 512
                          : base == "pixel_freq"              ? 128.0f
                          : base == "fps"                     ? 24.0f
                                                              : knob(program, base);
      state.uniforms.push_back(value);
    }
    std::vector<const float*> in;
    std::vector<float*> out;
    for (auto& plane : inputs) in.push_back(plane.data());
    for (auto& plane : outputs) out.push_back(plane.data());
    RunStatus status;
    Scratch scratch;
    program.kernel->run_frame(state, status);
    program.kernel->run_samples(state, status, scratch, in.data(), out.data(),
                                static_cast<std::int64_t>(low.size()));
    for (auto& plane : outputs) plane.resize(low.size());
    return outputs;
  }

  // The value of a knob's component, as the program has it.
  static float knob(const Program& program, const std::string& name) {
    for (const Knob& knob : program.knobs)
      for (std::size_t k = 0; k < knob.value.size(); ++k) {
        const std::string part =
            knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(k);
        if (part == name) return knob.value[k];
      }
    return 0;
  }

  std::shared_ptr<const Program> plain_, bounds_;
};

}  // namespace pse::bounds::test
