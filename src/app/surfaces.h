// Rendering visible surfaces: the scene that --on or --scene asks for, the programs of its objects,
// and what a frame needs of both.
#pragma once

#include <optional>

#include "app/knobs.h"
#include "app/program_file.h"
#include "app/render_options.h"
#include "app/textures.h"
#include "surface/scene.h"
#include "surface/shader.h"
#include "surface/trace_call.h"

namespace pse::app {

// What an object, or the background, is shaded by.
struct SurfaceProgram {
  std::shared_ptr<const Program> program;
  std::vector<Knob> knobs;
  const Textures* textures = nullptr;
};

class Surfaces {
 public:
  // Reads the scene and its meshes. Throws Failure (usage, input).
  Surfaces(const RenderOptions& options, Session& session);

  // What programs may read of the scene.
  std::vector<StreamName> names() const;
  // All programs as one, for the executor.
  std::shared_ptr<const Program> combine(std::vector<SurfaceProgram> programs);

  // Sets the scene up for a frame; the states are filled as for the plane.
  void begin_frame(const ImagePlane& plane);
  std::shared_ptr<const SampleSource> source(const ir::Module& module) const;
  std::vector<std::pair<std::string, std::string>> identities() const;

 private:
  surface::Lens lens(const ImagePlane& plane) const;

  std::shared_ptr<const surface::Scene> scene_;
  std::optional<surface::Camera> camera_;
  std::vector<SurfaceProgram> programs_;
  std::vector<std::unique_ptr<surface::TraceCall>> calls_;
  std::shared_ptr<surface::Shader> shader_;
  std::unique_ptr<surface::Lens> lens_;
  std::vector<std::pair<std::string, std::string>> identities_;
};

// Whether these arguments ask for surfaces at all.
bool wants_surfaces(const RenderOptions& options);

// What is wrong with running the module without a scene; empty: nothing.
std::string needs_a_scene(const ir::Module& module);

// Uniforms of the plane and the knobs.
FrameState plane_state(const ir::Module& module, const ImagePlane& plane,
                       const std::vector<Knob>& knobs);

}  // namespace pse::app
