// `--prepass N` of `pse render`: runs the prepass of every frame and hands its images to the render
// as another input.
#pragma once

#include <filesystem>

#include "app/prepass.h"
#include "app/render_options.h"

namespace pse::app {

// The images of the prepass; removed with this object unless the user named them.
class PrepassStage {
 public:
  PrepassStage() = default;
  ~PrepassStage();
  PrepassStage(const PrepassStage&) = delete;
  PrepassStage& operator=(const PrepassStage&) = delete;

  // Adds the image `prepass` to `options`. Throws Failure. Returns how a stopped run should end.
  Exit run(Session& session, RenderOptions& options, const ProgramFile& rendered,
           const std::vector<KnobSetting>& settings, Signals& signals);

 private:
  std::filesystem::path folder_;
};

}  // namespace pse::app
