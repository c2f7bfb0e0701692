// From --on to a scene, and from programs to one program.
#include "app/surfaces.h"

#include <fmt/format.h>

#include "app/input_images.h"
#include "app/knobs.h"
#include "surface/shape_words.h"

namespace pse::app {
namespace {

[[noreturn]] void throw_failure(const surface::ShapeError& error) {
  throw Failure(error.usage ? Exit::usage : Exit::input, error.message, error.hint);
}

// One light from above on the left, behind the eye.
surface::Light usual_light() { return {{-0.55, 0.75, 0.6}, false, {1, 1, 1}, 0}; }

}  // namespace

bool wants_surfaces(const RenderOptions& options) { return !options.on.empty(); }

Surfaces::Surfaces(const RenderOptions& options, Session& session) {
  identities_.emplace_back("--on " + options.on, "");
  auto spec = surface::parse_shape(options.on);
  if (!spec) throw_failure(spec.error());
  if (!surface::is_shape_name(spec->shape)) {
    spec->shape = session.find_file(spec->shape);
    identities_.emplace_back(spec->shape, file_identity(spec->shape));
  }
  const auto made = surface::make_shape(*spec, true);
  if (!made) throw_failure(made.error());
  for (const std::string& note : made->notes) session.console.warning(note);
  scene_ = std::make_shared<surface::Scene>(
      std::vector<surface::Object>{{spec->shape, made->shape, {}, 0}},
      std::vector<surface::Light>{usual_light()});
}

std::vector<StreamName> Surfaces::names() const {
  return surface::surface_names(scene_->lights().size());
}

std::shared_ptr<const Program> Surfaces::combine(std::vector<SurfaceProgram> programs) {
  programs_ = std::move(programs);
  std::vector<std::shared_ptr<const Program>> compiled;
  for (const SurfaceProgram& part : programs_) compiled.push_back(part.program);
  std::vector<int> program_of = {-1};
  for (std::size_t i = 0; i < scene_->objects(); ++i)
    program_of.push_back(scene_->object(i).program);
  shader_ = std::make_shared<surface::Shader>(std::move(compiled), std::move(program_of));
  for (const auto what : {surface::TraceCall::What::trace, surface::TraceCall::What::radiance,
                          surface::TraceCall::What::visible})
    calls_.push_back(
        std::make_unique<surface::TraceCall>(surface::TraceCall{what, shader_.get()}));
  return surface::Shader::combined(shader_);
}

surface::Lens Surfaces::lens(const ImagePlane& plane) const {
  const double aspect = double(plane.width) / plane.height;
  return {camera_.value_or(surface::framing(scene_->bounds(), aspect)), plane.width, plane.height};
}

void Surfaces::begin_frame(const ImagePlane& plane) {
  lens_ = std::make_unique<surface::Lens>(lens(plane));
  std::vector<FrameState> states;
  for (const SurfaceProgram& part : programs_) {
    const ir::Module& module = part.program->module();
    FrameState state = plane_state(module, plane, part.knobs);
    surface::set_scene_uniforms(module, *scene_, *lens_, state);
    state.externals = part.textures->functions();
    for (std::size_t i = 0; i < module.externals.size(); ++i)
      if (const auto what = surface::TraceCall::of(module.externals[i].name))
        state.externals[i] = {&surface::TraceCall::run,
                              calls_[static_cast<std::size_t>(*what)].get()};
    states.push_back(std::move(state));
  }
  shader_->begin_frame(std::move(states), scene_, *lens_);
}

std::shared_ptr<const SampleSource> Surfaces::source(const ir::Module& module) const {
  return std::make_shared<surface::SurfaceSource>(module, scene_, *lens_);
}

std::vector<std::pair<std::string, std::string>> Surfaces::identities() const {
  auto all = identities_;
  for (const SurfaceProgram& part : programs_)
    for (const auto& texture : part.textures->identities()) all.push_back(texture);
  return all;
}

std::string needs_a_scene(const ir::Module& module) {
  for (const ir::External& external : module.externals)
    if (surface::TraceCall::of(external.name))
      return fmt::format("the program calls {}(), and there is no scene", external.name);
  return "";
}

FrameState plane_state(const ir::Module& module, const ImagePlane& plane,
                       const std::vector<Knob>& knobs) {
  FrameState state;
  set_plane_uniforms(module, plane, state);
  set_knob_uniforms(module, knobs, state);
  return state;
}

}  // namespace pse::app
