// `pse bake` of a program into grids, frame by frame.
#pragma once

#include "app/bake_options.h"
#include "app/progress.h"
#include "app/provenance.h"
#include "app/signals.h"
#include "app/textures.h"
#include "volume/bake.h"

namespace pse::app {

class BakeJob {
 public:
  BakeJob(Session& session, const VolumeOptions& options, const SourceMap& sources, FileId file,
          std::shared_ptr<const Program> program, std::vector<Knob> knobs,
          const Textures& inputs, Signals& signals);

  // All frames. Throws Failure; returns how a stopped or failed run should end.
  Exit run();

 private:
  Exit run_frame(int index, int frame);
  volume::BakedGrid plan_grid(const ProgramOutput& output) const;
  void report_failure(const volume::BakeResult& result);
  void report_result(const volume::BakeResult& result, const std::string& name);

  Session& session_;
  const VolumeOptions& options_;
  const SourceMap& sources_;
  const FileId file_;
  const std::shared_ptr<const Program> program_;
  const std::vector<Knob> knobs_;
  const Textures& inputs_;
  Signals& signals_;
  volume::Vdb* vdb_ = nullptr;
  volume::Lattice lattice_;
  std::vector<volume::BakedGrid> grids_;
  std::vector<int> frames_;
  RunStatus status_;
  Progress progress_;
};

// The names of grids that a program makes when it is not asked for others.
inline constexpr std::array<std::string_view, 4> usual_grids = {"density", "temperature", "color",
                                                                "distance"};

// Writes a VDB file in one step. Throws Failure (output). `recipe`: 32 hexadecimal digits.
void write_grids(volume::GridWriter& writer, const std::string& name,
                 std::map<std::string, std::string> attributes, const std::string& recipe,
                 bool provenance);
// Whether `name` is there and was made by this recipe.
bool is_baked(volume::Vdb& vdb, const std::string& name, const std::string& recipe);

}  // namespace pse::app
