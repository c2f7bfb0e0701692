// Runs a program's text on a small picture and says what came out: for tests whose cases are
// programs.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "stream/executor.h"
#include "stream/image_plane.h"

namespace pse::test {

struct TextRun {
  SourceMap sources;
  Diagnostics diagnostics;
  std::shared_ptr<const Program> program;  // null after errors
  RunEnd end = RunEnd::failed;
  std::string failure;  // a failed check, as "file:line:column: message"
  std::map<std::string, std::vector<float>> outputs;  // name -> components at the looked-at pixel
  bool all_finite = true;                             // of all outputs at all pixels
  std::string printed() const { return print_text(diagnostics, sources, false); }
};

struct TextRunOptions {
  int width = 5, height = 5;
  bool interpret = false;
  int frame = 1;
  std::map<std::string, std::string> modules;  // name -> text
};

// The middle pixel is the one looked at.
inline TextRun run_text(const std::string& name, const std::string& text,
                        const TextRunOptions& options = {}) {
  TextRun run;
  LowerHost host;
  host.find_module = [&](SourceMap& sources, const std::string& module) -> std::optional<FileId> {
    const auto found = options.modules.find(module);
    if (found == options.modules.end()) return {};
    return sources.add(module + ".pse", found->second);
  };
  CompileOptions compile_options;
  compile_options.lower.stream = image_plane_names();
  compile_options.interpret = options.interpret;
  const FileId file = run.sources.add(name, text);
  run.program = compile(run.sources, file, host, compile_options, run.diagnostics);
  if (!run.program) return run;
  const ir::Module& module = run.program->module();

  // The frame: the plane's names, and every knob at the program's own value.
  ImagePlane plane;
  plane.width = options.width;
  plane.height = options.height;
  plane.frame = options.frame;
  FrameState state;
  set_plane_uniforms(module, plane, state);
  for (const Knob& knob : run.program->knobs)
    for (std::size_t i = 0; i < module.inputs.size(); ++i)
      for (std::size_t c = 0; c < knob.value.size(); ++c)
        if (module.inputs[i].name ==
            (knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(c)))
          state.uniforms[i] = knob.value[c];

  // Run it all in one thread, and keep the middle pixel.
  ExecuteOptions execute_options;
  execute_options.window = {0, 0, options.width, options.height};
  execute_options.threads = 1;
  RunStatus status;
  std::vector<float> middle(module.outputs.size());
  const TileSink sink = [&](const TileView& tile) {
    const std::int64_t at =
        static_cast<std::int64_t>(options.height / 2 - tile.rect.y0) * tile.rect.width() +
        (options.width / 2 - tile.rect.x0);
    for (std::size_t o = 0; o < module.outputs.size(); ++o) {
      for (std::int64_t i = 0; i < tile.count; ++i)
        run.all_finite =
            run.all_finite && std::abs(tile.planes[o][i]) <= std::numeric_limits<float>::max();
      middle[o] = tile.planes[o][at];
    }
  };
  const RunResult result =
      execute(*run.program, state, image_plane_source(module, plane, execute_options.window), sink,
              execute_options, status);
  run.end = result.end;
  if (result.failed_check >= 0) {
    const ir::Check& check = module.checks[static_cast<std::size_t>(result.failed_check)];
    run.failure = run.sources.describe(check.span) + ": " + check.message;
  }
  std::size_t next = 0;
  for (const ProgramOutput& output : run.program->outputs)
    for (int c = 0; c < output.components; ++c) run.outputs[output.name].push_back(middle[next++]);
  return run;
}

}  // namespace pse::test
