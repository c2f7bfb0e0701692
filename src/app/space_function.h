// A program as a function of space: what an isosurface is an isosurface of. It reads `point` and
// the frame's names, and sets a number: `density`, or the first that it sets.
#pragma once

#include "app/render_options.h"
#include "app/session.h"
#include "stream/program.h"
#include "surface/shapes.h"

namespace pse::app {

class SpaceFunction {
 public:
  // Throws Failure (program) after the errors have been reported.
  SpaceFunction(const std::string& path, const RenderOptions& options, Session& session);

  // Computes what holds for a frame. `run` stops the function, now and when the field is asked; it
  // must live until the next frame. Throws Failure (running).
  void begin_frame(const ImagePlane& plane, const RunStatus& run);
  // Valid as long as this, between begin_frame and the next.
  surface::Field field() const;

 private:
  std::shared_ptr<const Program> program_;
  std::string path_;
  std::size_t output_ = 0;
  std::vector<int> axis_of_;  // module input -> 0, 1, 2, or -1
  FrameState state_;
  const RunStatus* run_ = nullptr;
};

}  // namespace pse::app
