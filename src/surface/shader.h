// Several programs as one: every sample is shaded by the program of the object it shows. To the
// executor it is a program like any other, so tiles, supersampling and files work as for pictures.
// Samples that show nothing are black and transparent, or shaded by a background program. The third
// step of the flow of a surface picture; trace() of a program comes back here through
// surface/trace_call.h.
#pragma once

#include "stream/program.h"
#include "surface/surface_source.h"

namespace pse::surface {

class Shader : public Kernel {
 public:
  // program_of[id] is an index of `programs` for what has that id, id 0 being the background, or
  // -1 for nothing. The last is for all greater ids too. With paths, one more output "$path" tells
  // samples apart that show different objects or took different ways through their programs, and
  // "$ends" those whose searches ended elsewhere (antialias/path.h) or, of traced pictures, that
  // show a fold of one object: a part of it that hides another, or meets it at an angle.
  enum class Paths : std::uint8_t { none, of_stored, of_traced };
  Shader(std::vector<std::shared_ptr<const Program>> programs, std::vector<int> program_of,
         Paths paths = Paths::none);

  // The programs as one: it reads what any of them reads at sample rate, and `id`, and sets what
  // any of them sets, and `alpha`: 1 where a program ran that does not set it.
  static std::shared_ptr<const Program> combined(std::shared_ptr<Shader> shader);

  // What holds for a frame: one state per program, filled but not run.
  void begin_frame(std::vector<FrameState> states);
  // The same with a scene, for trace().
  void begin_frame(std::vector<FrameState> states, std::shared_ptr<const Scene> scene,
                   const Lens& lens);
  const Scene* scene() const { return scene_.get(); }
  bool shades_background() const { return program_of_.front() >= 0; }

  int width() const override;
  TierSamples tier_samples() const override;
  void run_frame(FrameState& state, RunStatus& status) const override;
  void run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                   const float* const* inputs, float* const* outputs,
                   std::int64_t count) const override;

  // The colour and alpha of what rays meet, shaded by its own program: red, green, blue, alpha.
  // Nothing below `deepest` of such calls within each other. footprints: of the rays' beginnings.
  void radiance(std::span<const Ray> rays, double begin_width, float* const* rgba) const;
  static constexpr int deepest = 5;

 private:
  static constexpr std::size_t none = std::size_t(-1);
  struct Part {
    std::shared_ptr<const Program> program;
    // Module input -> input of the combined module, for those that it reads at sample rate; else
    // `none`.
    std::vector<std::size_t> input_of;
    std::vector<std::vector<std::size_t>> outputs_of;  // module output -> of the combined module
    bool sets_alpha = false;
    std::int32_t first_check = 0;
  };
  struct Room;
  void add_folds(const float* const* inputs, float* ends, std::int64_t count) const;
  void run_part(std::size_t part, RunStatus& status, const float* const* inputs,
                float* const* outputs, std::int64_t count, Room& room) const;
  void make_module();

  std::vector<Part> parts_;
  std::vector<int> program_of_;
  std::shared_ptr<passes::SplitModule> split_;
  std::vector<ProgramOutput> outputs_;
  std::size_t id_input_ = 0, alpha_output_ = 0, path_output_ = 0;
  const Paths paths_;
  // Of traced pictures with paths: the inputs that tell of folds.
  std::size_t depth_input_ = 0;
  std::array<std::size_t, 3> normal_inputs_{none, none, none};  // where some program reads them
  std::array<std::size_t, 3> color_outputs_{};
  bool has_color_ = false;

  mutable std::vector<FrameState> states_;
  mutable bool ready_ = false;
  std::shared_ptr<const Scene> scene_;
  std::unique_ptr<NameWriter> names_;
  std::unique_ptr<Lens> lens_;
};

}  // namespace pse::surface
