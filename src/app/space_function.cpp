// Compiling a space function and asking it for many points.
#include "app/space_function.h"

#include <fmt/format.h>

#include "app/program_file.h"
#include "app/report.h"
#include "app/surfaces.h"
#include "stream/planes.h"

namespace pse::app {

SpaceFunction::SpaceFunction(const std::string& path, const RenderOptions& options,
                             Session& session)
    : path_(path) {
  ProgramFile file = read_program(path, session);
  CompileOptions compile_with;
  compile_with.lower.stream = {{"point", 3, ir::Rate::sample, ir::InputSlopes::of_frame}};
  for (const StreamName& name : image_plane_names())
    if (name.rate == ir::Rate::frame) compile_with.lower.stream.push_back(name);
  compile_with.tier = options.tier;
  compile_with.interpret = options.interpret;
  compile_with.codegen.width = options.width;
  Diagnostics diagnostics;
  program_ =
      compile(file.sources, file.file, module_host(path, session), compile_with, diagnostics);
  report(diagnostics, file.sources, session);
  if (!program_) throw Failure(Exit::program, "");

  // Which of its outputs.
  const ProgramOutput* chosen = nullptr;
  for (const ProgramOutput& output : program_->outputs)
    if (output.components == 1 && (chosen == nullptr || output.name == "density")) chosen = &output;
  if (chosen == nullptr)
    throw Failure(Exit::program, fmt::format("{}: a space function sets a number", path),
                  "density = 1 - norm(point)");
  const ir::Module& module = program_->module();
  if (!module.externals.empty())
    throw Failure(Exit::program,
                  fmt::format("{}: a space function looks up no pictures and sends no rays", path));
  for (std::size_t o = 0; o < module.outputs.size(); ++o)
    if (module.outputs[o].name == chosen->name) output_ = o;
  for (const ir::Input& input : module.inputs)
    axis_of_.push_back(input.rate == ir::Rate::sample ? input.name.back() - '0' : -1);
}

void SpaceFunction::begin_frame(const ImagePlane& plane, const RunStatus& run) {
  run_ = &run;
  state_ = plane_state(program_->module(), plane, program_->knobs);
  RunStatus status{.outer = run_};
  program_->kernel->run_frame(state_, status);
  if (status.failed_check >= 0)
    throw Failure(
        Exit::running,
        fmt::format(
            "{}: {}", path_,
            program_->module().checks[static_cast<std::size_t>(status.failed_check)].message));
}

surface::Field SpaceFunction::field() const {
  return [this](std::int64_t count, const float* x, const float* y, const float* z,
                float* values) {
    const float* const axes[3] = {x, y, z};
    std::vector<const float*> inputs;
    for (const int axis : axis_of_) inputs.push_back(axis < 0 ? nullptr : axes[axis]);
    const std::vector<bool> all(program_->module().outputs.size(), true);
    const Planes outputs(all, count);
    RunStatus status{.outer = run_};
    Scratch scratch;
    program_->kernel->run_samples(state_, status, scratch, inputs.data(),
                                  outputs.pointers().data(), count);
    std::copy_n(outputs.pointers()[output_], count, values);
  };
}

}  // namespace pse::app
