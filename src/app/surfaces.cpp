// From --on or a scene file to objects, and from programs to one program.
#include "app/surfaces.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <set>

#include "antialias/kept.h"
#include "antialias/path.h"
#include "app/input_images.h"
#include "app/knobs.h"
#include "surface/shape_words.h"

namespace pse::app {
namespace {

namespace fs = std::filesystem;

// In metres: single precision squares lengths within meshes.
constexpr double largest_size = 1e15;

// One light from above on the left, behind the eye.
surface::Light usual_light() { return {{-0.55, 0.75, 0.6}, false, {1, 1, 1}, 0}; }

// Beside the file that names it, else as the session finds it.
std::string find_beside(const std::string& owner, const std::string& name, const Session& session) {
  std::error_code error;
  const fs::path beside = fs::path(owner).parent_path() / name;
  if (fs::path(name).is_relative() && fs::exists(beside, error)) return beside.string();
  return session.find_file(name);
}

// Two sources; the second has the last word.
class Both : public SampleSource {
 public:
  Both(std::unique_ptr<SampleSource> first, std::unique_ptr<SampleSource> second)
      : first_(std::move(first)), second_(std::move(second)) {}
  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const override {
    first_->fill(x, y, planes), second_->fill(x, y, planes);
  }
  bool anywhere() const override { return first_->anywhere() && second_->anywhere(); }
  bool brings_slope(const std::string& input) const override {
    return second_->brings_slope(input);
  }

 private:
  std::unique_ptr<SampleSource> first_, second_;
};

// The eye turned round the target.
surface::Camera orbited(surface::Camera camera, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const surface::Vec3 axis = normalized(camera.up), arm = camera.eye - camera.target;
  camera.eye = camera.target + std::cos(angle) * arm + std::sin(angle) * cross(axis, arm) +
               (1 - std::cos(angle)) * dot(axis, arm) * axis;
  return camera;
}

}  // namespace

bool is_scene_name(const std::string& file) { return fs::path(file).extension() == ".toml"; }

const char* const trace_program =
    "P = place\nN = normal\nZ = depth\nalpha = hit\npoint = point\nuv = uv\nid = id\n"
    "direction = direction\npixelsize = pixelsize\nbackface = backface\ndPdx = dPdx\ndPdy = dPdy\n";

bool wants_surfaces(const RenderOptions& options) {
  return !options.on.empty() || !options.scene.empty();
}

Surfaces::Surfaces(const RenderOptions& options, Session& session) : console_(session.console) {
  if (!options.on.empty() && !options.scene.empty())
    throw usage_error("--on and a scene file exclude each other");
  if (!options.scene.empty()) {
    read_scene(options, session);
  } else {
    const auto spec = surface::parse_shape(options.on);
    if (!spec) throw usage_error("--on: " + spec.error().message, spec.error().hint);
    identities_.emplace_back("--on " + options.on, "");
    scene_.objects.push_back({.name = spec->shape, .shape = *spec});
  }
  if (!options.camera.empty()) {
    scene_.camera = parse_camera(options.camera);
    identities_.emplace_back("--camera " + options.camera, "");
  }
  if (!scene_.has_lights) scene_.lights = {usual_light()};
  for (SceneObject& object : scene_.objects)
    if (!surface::is_shape_name(object.shape.shape)) {
      const std::string found = find_beside(scene_.path, object.shape.shape, session);
      object.shape.shape = found;
      identities_.emplace_back(found, file_identity(found));
    }
  if (options.trace) {
    // One program for all, and for the background, which has directions.
    program_of_.assign(scene_.objects.size() + 1, 0);
    requests_.emplace_back();
    return;
  }
  program_of_ = {
      scene_.background.empty() ? -1 : program_index(scene_.background, {}, options, session)};
  for (const SceneObject& object : scene_.objects)
    program_of_.push_back(program_index(object.program, object.knobs, options, session));
}

std::unique_ptr<Surfaces> Surfaces::stored(const RenderOptions& options, Session& session,
                                           InputImages& images) {
  const auto bare = images.bare();
  if (!bare) return nullptr;
  const surface::SurfaceLayers layers = surface::surface_layers(bare->layers);
  if (layers.empty()) return nullptr;
  auto surfaces = std::make_unique<Surfaces>(Nothing{}, session);
  surfaces->images_ = &images;
  surfaces->layers_ = layers;
  surfaces->stored_.lights = {usual_light()};
  surface::read_gbuffer_attributes(bare->reader.spec().attributes, surfaces->stored_);
  if (!options.camera.empty()) {
    const SceneCamera camera = parse_camera(options.camera);
    if (camera.has_eye) surfaces->stored_.eye = camera.camera.eye;
    surfaces->identities_.emplace_back("--camera " + options.camera, "");
  }
  surfaces->requests_.emplace_back();
  surfaces->program_of_ = {-1, 0};
  std::vector<std::string> hidden;
  for (const StreamName& name : surfaces->names()) hidden.push_back(name.name);
  images.hide(std::move(hidden));
  return surfaces;
}

void Surfaces::read_scene(const RenderOptions& options, Session& session) {
  const std::string path = session.find_file(options.scene);
  scene_ = read_scene_file(path);
  identities_.emplace_back(path, file_identity(path));
}

void Surfaces::load(const RenderOptions& options, Session& session) {
  for (const SceneObject& object : scene_.objects) {
    const auto made = [&] {
      if (!surface::is_field_name(object.shape.shape))
        return surface::make_shape(object.shape, options.scene.empty());
      functions_.push_back(std::make_unique<SpaceFunction>(object.shape.shape, options, session));
      return surface::make_field_shape(object.shape, functions_.back()->field());
    }();
    if (!made) {
      const surface::ShapeError& error = made.error();
      if (scene_.path.empty())
        throw Failure(error.usage ? Exit::usage : Exit::input,
                      (error.usage ? "--on: " : "") + error.message, error.hint);
      throw Failure(Exit::input, fmt::format("{}:{}: {}", scene_.path, error.line, error.message),
                    error.hint);
    }
    for (const std::string& note : made->notes) console_.warning("mesh", note);
    shapes_.push_back(made->shape);
  }
}

// Objects with the same program and knobs share one.
int Surfaces::program_index(const std::string& written, const std::vector<KnobSetting>& knobs,
                            const RenderOptions& options, const Session& session) {
  ProgramRequest request;
  const std::string& name = written.empty() ? scene_.program : written;
  if (!name.empty())
    request.file = find_beside(scene_.path, name, session);
  else if (is_scene_name(options.program))
    throw Failure(Exit::input, fmt::format("{}: an object has no program", scene_.path),
                  R"(add program = "marble.pse", to the object or above all tables)");
  request.knobs = knobs;
  const auto same = [&](const ProgramRequest& other) {
    return other.file == request.file &&
           std::equal(other.knobs.begin(), other.knobs.end(), request.knobs.begin(),
                      request.knobs.end(), [](const KnobSetting& a, const KnobSetting& b) {
                        return a.name == b.name && a.text == b.text;
                      });
  };
  const auto found = std::find_if(requests_.begin(), requests_.end(), same);
  if (found != requests_.end()) return static_cast<int>(found - requests_.begin());
  if (!request.file.empty()) identities_.emplace_back(request.file, file_identity(request.file));
  requests_.push_back(std::move(request));
  return static_cast<int>(requests_.size()) - 1;
}

std::vector<StreamName> Surfaces::names() const {
  if (is_stored()) return surface::gbuffer_names(layers_, images_->bare()->layers, stored_);
  return surface::surface_names(scene_.lights.size());
}

Surfaces::Joined Surfaces::join(const std::vector<std::shared_ptr<const Program>>& of_parts,
                                bool paths) const {
  Joined joined;
  std::vector<int> place(of_parts.size(), -1), program_of;
  for (std::size_t i = 0; i < of_parts.size(); ++i) {
    if (!of_parts[i]) continue;
    place[i] = static_cast<int>(joined.programs.size());
    joined.programs.push_back(of_parts[i]);
    joined.parts.push_back(i);
  }
  for (const int part : program_of_)
    program_of.push_back(part < 0 ? -1 : place[static_cast<std::size_t>(part)]);
  using Paths = surface::Shader::Paths;
  joined.shader = std::make_shared<surface::Shader>(joined.programs, program_of,
                                                    !paths        ? Paths::none
                                                    : is_stored() ? Paths::of_stored
                                                                  : Paths::of_traced);
  return joined;
}

// An output is what the least of the programs that set it says of it.
std::vector<antialias::Course> Surfaces::courses_of(const antialias::Programs& all) const {
  const auto base = [](const std::string& name) { return name.substr(0, name.find('.')); };
  std::vector<antialias::Course> courses(all.outputs, antialias::Course::even);
  for (const SurfaceProgram& part : programs_)
    for (std::size_t own = 0; own < part.programs.courses.size(); ++own)
      for (std::size_t o = 0; o < all.outputs; ++o)
        if (base(part.programs.shown->module().outputs[own].name) ==
            base(all.shown->module().outputs[o].name))
          courses[o] = std::max(courses[o], part.programs.courses[own]);
  return courses;
}

antialias::Programs Surfaces::combine(std::vector<SurfaceProgram> programs, antialias::Mode mode) {
  programs_ = std::move(programs);
  using List = std::vector<std::shared_ptr<const Program>>;
  List shown, quiet, edges, conditions;
  for (const SurfaceProgram& part : programs_) {
    if (const std::string problem = needs_a_scene(part.programs.shown->module());
        is_stored() && !problem.empty())
      throw usage_error(problem + ": a traced picture has none", "--on SHAPE or --scene FILE");
    shown.push_back(part.programs.shown);
    quiet.push_back(part.programs.quiet);
    edges.push_back(nullptr), conditions.push_back(nullptr);
    if (is_stored() && part.programs.conditions.valid()) {
      const auto& compiled = part.programs.conditions.get();
      if (!compiled) throw Failure(Exit::program, compiled.error());
      conditions.back() = *compiled;
    }
    if (is_stored() || !part.programs.edges.valid()) continue;
    const auto& compiled = part.programs.edges.get();
    if (!compiled) throw Failure(Exit::program, compiled.error());
    edges.back() = *compiled;
  }
  const auto add = [&](const List& list, bool paths) {
    joined_.push_back(join(list, paths));
    return surface::Shader::combined(joined_.back().shader);
  };
  antialias::Programs all;
  all.has_paths = mode == antialias::Mode::procedural;
  all.kept = std::make_shared<antialias::Kept>();
  // Of a frame nothing is known that holds for all objects.
  all.has_untold_noise = true;
  all.shown = all.quiet = add(shown, all.has_paths);
  const auto& outputs = all.shown->module().outputs;
  const auto path = std::ranges::find(outputs, antialias::path_name, &ir::Output::name);
  all.outputs = static_cast<std::size_t>(path - outputs.begin());
  for (const auto what : {surface::TraceCall::What::trace, surface::TraceCall::What::radiance,
                          surface::TraceCall::What::visible})
    calls_.push_back(std::make_unique<surface::TraceCall>(
        surface::TraceCall{what, joined_.front().shader.get()}));
  all.courses = courses_of(all);
  if (quiet != shown) all.quiet = add(quiet, all.has_paths);
  const auto ready = [&](const List& list) {
    std::promise<antialias::Programs::Result> made;
    made.set_value(add(list, false));
    return made.get_future().share();
  };
  if (all.has_paths && edges != List(edges.size())) all.edges = ready(edges);
  if (all.has_paths && conditions != List(conditions.size())) all.conditions = ready(conditions);
  return all;
}

// What is not told is chosen so that all objects are seen.
surface::Camera Surfaces::camera(const ImagePlane& plane, const surface::Scene& scene) const {
  const double aspect = double(plane.width) / plane.height;
  const SceneCamera asked = scene_.camera.value_or(SceneCamera{});
  surface::Camera camera = asked.camera;
  if (!asked.has_eye) {
    const surface::Camera usual = surface::framing(scene.bounds(), aspect, camera.fov);
    camera.eye = usual.eye, camera.target = usual.target;
  } else if (!asked.has_target && scene.bounds().bounded()) {
    camera.target = scene.bounds().centre();
  }
  return orbited(camera, asked.orbit * plane.frame / plane.fps);
}

void Surfaces::begin_frame(const ImagePlane& plane, const RunStatus& run) {
  if (is_stored()) {
    begin_stored_frame();
    for (const Joined& joined : joined_) joined.shader->begin_frame(states(joined, plane));
    return;
  }
  for (const auto& function : functions_) function->begin_frame(plane, run);
  warn_unseen();
  // Place the objects.
  std::vector<surface::Object> objects;
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    objects.push_back({scene_.objects[i].name, shapes_[i],
                       scene_.objects[i].placement.at_time(plane.frame / plane.fps),
                       program_of_[i + 1]});
  placed_ = std::make_shared<surface::Scene>(std::move(objects), scene_.lights);
  const surface::Camera seen = camera(plane, *placed_);
  lens_ = std::make_unique<surface::Lens>(seen, plane.width, plane.height);
  warn_inside(seen);
  warn_too_thin();
  for (const Joined& joined : joined_)
    joined.shader->begin_frame(states(joined, plane), placed_, *lens_);
}

std::vector<FrameState> Surfaces::states(const Joined& joined, const ImagePlane& plane) const {
  std::vector<FrameState> states;
  for (std::size_t k = 0; k < joined.programs.size(); ++k) {
    const SurfaceProgram& part = programs_[joined.parts[k]];
    const ir::Module& module = joined.programs[k]->module();
    FrameState state = plane_state(module, plane, part.knobs);
    surface::set_scene_uniforms(module, is_stored() ? stored_.lights : scene_.lights,
                                is_stored() ? stored_.eye.value_or(surface::Vec3{}) : lens_->eye(),
                                state);
    state.externals = part.textures->functions();
    for (std::size_t i = 0; i < module.externals.size(); ++i)
      if (const auto what = surface::TraceCall::of(module.externals[i].name))
        state.externals[i] = {&surface::TraceCall::run,
                              calls_[static_cast<std::size_t>(*what)].get()};
    part.expectations->bind(module, state.externals);
    states.push_back(std::move(state));
  }
  return states;
}

std::vector<Expectations*> Surfaces::expectations() const {
  std::vector<Expectations*> all;
  for (const SurfaceProgram& part : programs_) all.push_back(part.expectations.get());
  return all;
}

// Reads what the program wants, and what that follows from; once for all frames of the same file.
void Surfaces::begin_stored_frame() {
  const auto bare = images_->bare();
  surface::read_gbuffer_attributes(bare->reader.spec().attributes, stored_);
  std::set<std::string> layers, channels;
  for (const Joined& joined : joined_)
    for (const std::string& name :
         surface::layers_wanted(surface::Shader::combined(joined.shader)->module(), layers_))
      layers.insert(name);
  for (const std::string& name : layers)
    for (const int channel : image::find_layer(bare->layers, name)->channels)
      channels.insert(bare->reader.spec().channels[static_cast<std::size_t>(channel)].name);
  const std::vector<std::string> names(channels.begin(), channels.end());
  std::vector<std::string> of = names;
  of.push_back(bare->file);
  if (of == picture_of_) return;
  picture_.reset(), picture_of_.clear();  // not both in memory
  auto picture = image::read_image(bare->reader, {}, names);
  if (!picture) throw Failure(Exit::input, picture.error().message);
  for (const std::string& what :
       surface::clear_broken_pixels(*picture, layers_, bare->layers, bare->reader.spec()))
    console_.warning("not-finite", bare->file + ": " + what);
  picture_ = std::make_shared<const image::Image>(std::move(*picture));
  picture_of_ = std::move(of);
}

void Surfaces::warn_inside(const surface::Camera& camera) {
  const std::vector<std::string> around = placed_->around(camera.eye);
  if (around.empty() || warned_) return;
  warned_ = true;
  console_.warning("inside", fmt::format("the camera is inside {}: what is seen is its back",
                                         fmt::join(around, ", ")));
}

// Once, of the first frame in which something is not to be seen.
void Surfaces::warn_unseen() {
  for (std::size_t i = 0; i < shapes_.size() && !warned_unseen_; ++i) {
    const std::string why = shapes_[i]->why_unseen();
    if (why.empty()) continue;
    warned_unseen_ = true;
    console_.warning("unseen",
                     fmt::format("nothing is seen of {}: {}", scene_.objects[i].shape.shape, why));
  }
}

// Once, of the first frame in which an object falls between the pixels.
void Surfaces::warn_too_thin() {
  for (std::size_t i = 0; i < placed_->objects() && !warned_thin_; ++i) {
    const surface::Object& object = placed_->object(i);
    const double thick =
        object.shape->thickness() * std::cbrt(std::abs(object.to_world.determinant()));
    if (!std::isfinite(thick)) continue;
    const double pixel =
        lens_->project(object.to_world.point(object.shape->bounds().centre())).pixel;
    const bool is_huge = thick > largest_size;
    if (!is_huge && !(thick < 0.25 * pixel)) continue;
    warned_thin_ = true;
    const std::string& name = scene_.objects[i].shape.shape;
    if (is_huge)
      console_.warning(
          "unseen",
          fmt::format(
              "{} is {:.2g} m wide, and rays meet nothing larger than {:.0g} m; scale it down",
              name, thick, largest_size));
    else
      console_.warning("unseen", fmt::format("little or nothing is seen of {}: it is {:.2g} m "
                                             "thick where a pixel is {:.2g} m wide; "
                                             "make it larger, or come nearer with the camera",
                                             name, thick, pixel));
  }
}

std::unique_ptr<SampleSource> Surfaces::samples(const ir::Module& module,
                                                const ImagePlane& plane) const {
  std::unique_ptr<SampleSource> surfaces;
  if (is_stored()) {
    const auto bare = images_->bare();
    surfaces = std::make_unique<surface::GBuffer>(module, layers_, bare->layers,
                                                  bare->reader.spec(), picture_, stored_);
  } else {
    surfaces = std::make_unique<surface::SurfaceSource>(
        module, placed_, *lens_, joined_.front().shader->shades_background());
  }
  return std::make_unique<Both>(image_plane_samples(module, plane), std::move(surfaces));
}

std::map<std::string, std::string> Surfaces::attributes() const {
  if (is_stored()) return surface::gbuffer_attributes(stored_);
  return surface::gbuffer_attributes({lens_->eye(), scene_.lights});
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
