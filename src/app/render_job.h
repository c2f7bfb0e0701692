// A compiled program with its knobs, images and files, run frame by frame.
#pragma once

#include "antialias/antialias.h"
#include "app/frame_writer.h"
#include "app/input_images.h"
#include "app/progress.h"
#include "app/provenance.h"
#include "app/signals.h"
#include "app/stats.h"
#include "app/surfaces.h"
#include "app/textures.h"

namespace pse::app {

class RenderJob {
 public:
  // `images` has the first frame open.
  RenderJob(Session& session, const RenderOptions& options, const SourceMap& sources, FileId file,
            antialias::Programs programs, std::vector<Knob> knobs, InputImages& images,
            const Textures& textures, Surfaces* surfaces, Signals& signals);

  // All frames. Throws Failure; returns how a stopped or failed run should end.
  Exit run();
  const RunStats& stats() const { return stats_; }

 private:
  Exit run_frame(int index, int frame);
  Rect choose_window() const;
  bool skip_done(int frame, const std::vector<std::string>& recipes) const;
  FrameState frame_state(const Program& program) const;
  antialias::Options antialias() const;
  bool reads_stored() const;
  image::Result<std::unique_ptr<image::ImageWriter>> open_writer(std::size_t file,
                                                                 const std::string& name,
                                                                 const image::ImageSpec& spec);
  void close_films();
  RunResult compute(const TileSource& source, FrameWriter* writer);
  void write_snapshots(FrameWriter& writer);
  void check_channels() const;
  void report_failure(const RunResult& result, int frame);
  void warn(const FrameWriter& writer);
  void find_not_finite(const FrameWriter& writer, Diagnostics& diagnostics);

  Session& session_;
  const RenderOptions& options_;
  const SourceMap& sources_;
  const FileId file_;
  const antialias::Programs programs_;
  const std::shared_ptr<const Program> program_;
  const std::vector<Knob> knobs_;
  InputImages& images_;
  const Textures& textures_;
  Surfaces* surfaces_;  // null: the image plane alone
  Signals& signals_;
  RunStatus status_;  // of all frames: once cancelled, no other begins
  std::vector<int> frames_;
  std::vector<PlannedFile> files_;
  std::vector<std::unique_ptr<image::MovieWriter>> films_;  // one per file; null where it is none
  std::vector<StreamName> first_names_;  // what the images of the first frame brought
  ImagePlane plane_;
  Rect window_;
  Progress progress_;
  Expectations own_expectations_;            // of the image plane's program
  std::vector<Expectations*> expectations_;  // of all programs
  std::vector<std::string> warned_;  // variables whose NaN has been reported
  RunStats stats_;
  bool count_operations_ = false;  // --stats: some samples are run a second time and counted
};

// The frames to compute: those asked for, those that an input sequence has, or one.
std::vector<int> choose_frames(const RenderOptions& options);

}  // namespace pse::app
