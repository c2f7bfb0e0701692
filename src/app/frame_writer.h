// The files of one frame while it is computed: a sink of tiles, and snapshots of what is there so
// far.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "app/output_plan.h"
#include "stream/executor.h"

namespace pse::app {

// What is not finite in one variable of one file.
struct NotFiniteChannel {
  std::size_t output = 0;  // index of Module::outputs
  image::NotFinite found;
};

// Opens the writer of one file: a picture of its own, or the next frame of a film.
using OpenWriter = std::function<image::Result<std::unique_ptr<image::ImageWriter>>(
    std::size_t file, const std::string& name, const image::ImageSpec& spec)>;

struct Snapshot {
  std::string name;
  int step = 1;  // it holds every step-th pixel of every step-th row
};

class FrameWriter {
 public:
  // `display` is the picture's place in file coordinates and `window` the part of it that is
  // computed, from its top left. recipes: one per file, to be stored in it; or none. Throws Failure
  // (output).
  FrameWriter(const std::vector<PlannedFile>& files, int frame, const image::ImageSpec& common,
              const Rect& window, image::NanPolicy nan, const std::vector<std::string>& recipes,
              const OpenWriter& open);

  // Takes tiles in order, one at a time. Throws Failure: `output`, or `strict` for NaN under --nan
  // error.
  void add(const TileView& tile);
  // Writes what has come so far beside each target, as NAME.snapshot.EXT, of large pictures every
  // nth pixel; may be called while tiles come. None for films and standard output.
  std::vector<Snapshot> write_snapshots();
  // Puts the files in their places and returns their names. Throws as add().
  std::vector<std::string> close();

  std::vector<NotFiniteChannel> not_finite() const;

 private:
  struct File {
    const PlannedFile* plan;
    std::string name;
    std::unique_ptr<image::ImageWriter> writer;
    std::shared_ptr<image::NanReport> report;
    std::vector<const float*> planes;    // of the tile at hand
    std::unique_ptr<image::Image> copy;  // for snapshots
    int step = 1;                        // of the copy
  };

  static void keep(File& file, const image::Window& place);

  Rect window_;
  image::Window data_;
  std::vector<File> files_;
  std::mutex copying_;  // of the copies
};

// "dir/out.exr" -> "dir/out.snapshot.exr"
std::string snapshot_name(const std::string& name);

}  // namespace pse::app
