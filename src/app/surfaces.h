// Rendering visible surfaces: the scene that --on or a scene file asks for, the programs of its
// objects, and what a frame needs of both.
#pragma once

#include <optional>

#include "antialias/programs.h"
#include "app/expectations.h"
#include "app/input_images.h"
#include "app/knobs.h"
#include "app/render_options.h"
#include "app/scene_file.h"
#include "app/space_function.h"
#include "app/textures.h"
#include "surface/gbuffer.h"
#include "surface/shader.h"
#include "surface/trace_call.h"

namespace pse::app {

// A program that some objects, or the background, are shaded by.
struct ProgramRequest {
  std::string file;                 // as found; empty: the command line's
  std::vector<KnobSetting> knobs;  // the scene's; the command line's come after them
};

struct SurfaceProgram {
  antialias::Programs programs;
  std::vector<Knob> knobs;
  std::unique_ptr<Textures> textures;
  std::unique_ptr<Expectations> expectations;
};

class Surfaces {
 public:
  // Reads the scene and finds its files. Throws Failure (usage, input).
  Surfaces(const RenderOptions& options, Session& session);
  // Reads the meshes, which may take seconds: once, before the first frame, and after what is wrong
  // with the programs was told. Throws Failure (usage, input).
  void load(const RenderOptions& options, Session& session);
  // Takes the surfaces of the images' bare picture (surface/gbuffer.h), if it has such; the images
  // then no longer bring these names. They must outlive this.
  static std::unique_ptr<Surfaces> stored(const RenderOptions& options, Session& session,
                                          InputImages& images);

  // The programs to compile, in the order in which combine() takes them.
  const std::vector<ProgramRequest>& programs() const { return requests_; }
  // What programs may read of the scene.
  std::vector<StreamName> names() const;
  // All programs as one, for the executor.
  antialias::Programs combine(std::vector<SurfaceProgram> programs, antialias::Mode mode);

  // Sets the scene up for a frame of this picture; `run` stops the functions of isosurfaces, and
  // must live until the next.
  void begin_frame(const ImagePlane& plane, const RunStatus& run);
  // The plane's names and the surfaces', at any places of the frame that was begun.
  std::unique_ptr<SampleSource> samples(const ir::Module& module, const ImagePlane& plane) const;
  // What a picture of these surfaces should say of them in its head.
  std::map<std::string, std::string> attributes() const;
  // Of all programs.
  std::vector<Expectations*> expectations() const;
  bool is_stored() const { return images_ != nullptr; }
  // Files read, with their identities.
  std::vector<std::pair<std::string, std::string>> identities() const;
  // The file whose text is the picture's recipe where there is no program: the scene's.
  const std::string& path() const { return scene_.path; }

  struct Nothing {};
  Surfaces(Nothing, Session& session) : console_(session.console) {}

 private:
  void read_scene(const RenderOptions& options, Session& session);
  int program_index(const std::string& written, const std::vector<KnobSetting>& knobs,
                    const RenderOptions& options, const Session& session);
  surface::Camera camera(const ImagePlane& plane, const surface::Scene& scene) const;
  void warn_inside(const surface::Camera& camera);
  void warn_unseen();
  void warn_too_thin();
  void begin_stored_frame();

  Console& console_;
  SceneFile scene_;
  std::vector<std::unique_ptr<SpaceFunction>> functions_;      // of isosurfaces
  std::vector<std::shared_ptr<const surface::Shape>> shapes_;  // of the objects
  std::vector<int> program_of_;                                // of the background, the objects
  std::vector<ProgramRequest> requests_;
  std::vector<SurfaceProgram> programs_;
  std::vector<std::unique_ptr<surface::TraceCall>> calls_;
  // A program of each part that has one, as one.
  struct Joined {
    std::shared_ptr<surface::Shader> shader;
    std::vector<std::shared_ptr<const Program>> programs;
    std::vector<std::size_t> parts;
  };
  Joined join(const std::vector<std::shared_ptr<const Program>>& of_parts, bool paths) const;
  std::vector<antialias::Course> courses_of(const antialias::Programs& all) const;
  std::vector<FrameState> states(const Joined& joined, const ImagePlane& plane) const;
  std::vector<Joined> joined_;  // the first is what is shown
  std::shared_ptr<const surface::Scene> placed_;  // of the frame
  std::unique_ptr<surface::Lens> lens_;
  std::vector<std::pair<std::string, std::string>> identities_;
  bool warned_ = false, warned_unseen_ = false, warned_thin_ = false;

  // Of stored surfaces.
  InputImages* images_ = nullptr;
  surface::SurfaceLayers layers_;
  surface::GBufferFrame stored_;
  std::shared_ptr<const image::Image> picture_;
  std::vector<std::string> picture_of_;  // the file and the channels that it was read from
};

// The program that `pse trace` runs: it sets what G-buffers hold.
extern const char* const trace_program;

// Whether these arguments ask for surfaces at all.
bool wants_surfaces(const RenderOptions& options);
// Whether the file is a scene by its name.
bool is_scene_name(const std::string& file);
// What is wrong with running the module without a scene; empty: nothing.
std::string needs_a_scene(const ir::Module& module);

// Uniforms of the plane and the knobs.
FrameState plane_state(const ir::Module& module, const ImagePlane& plane,
                       const std::vector<Knob>& knobs);

}  // namespace pse::app
