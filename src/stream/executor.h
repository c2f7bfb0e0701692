// Runs a program over a two-dimensional stream of samples, tile by tile, in parallel, with progress
// and cancellation.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stream/batches.h"
#include "stream/program.h"

namespace pse {

// Pixels [x0, x1) x [y0, y1).
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  friend bool operator==(const Rect&, const Rect&) = default;
};

// One tile being computed: samples in row-major order of `rect`.
struct TileView {
  Rect rect;
  std::int64_t count = 0;
  std::span<float* const>
      planes;  // sources fill, sinks read: one array per Module::inputs / Module::outputs entry
};

// Where samples come from. Called from several threads at once, each time for another tile.
using TileSource = std::function<void(const TileView& inputs)>;
// Where results go. Called from several threads at once unless `ordered_sink`.
using TileSink = std::function<void(const TileView& outputs)>;

struct ExecuteOptions {
  Rect window;
  int tile_width = 64;
  int tile_height = 64;
  int threads = 0;  // 0: as many as the machine has
  bool ordered_sink =
      false;  // the sink gets tiles one at a time, row of tiles by row of tiles, left to right
  std::function<void(double done)>
      progress;                  // 0..1, from one thread at a time, at most 20 times a second
  std::size_t memory_limit = 0;  // bytes of tiles alive at once; 0: what keeps the threads busy
};

struct RunResult {
  RunEnd end = RunEnd::finished;
  std::int32_t failed_check = -1;  // when failed: index of Module::checks
  int x = 0, y = 0;  // when failed: a pixel where it happened; (-1, -1) in the frame's part
  double seconds = 0;
};

// `state` must be filled for the frame (uniforms of knobs and frame names, externals); this runs
// the frame function. Setting status.cancel stops within 50 ms: each turn of a loop and each vector
// of samples looks at it, and a call of source or sink that has begun is waited for. Exceptions of
// source and sink stop the run and are thrown again from here. The result does not depend on tile
// size or threads.
RunResult execute(const Program& program, FrameState& state, const TileSource& source,
                  const TileSink& sink, const ExecuteOptions& options, RunStatus& status);

}  // namespace pse
