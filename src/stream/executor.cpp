// Cuts the window into tiles and runs them as batches.
#include "stream/executor.h"

#include <algorithm>
#include <chrono>

#include "stream/blocks.h"
#include "stream/tiling.h"

namespace pse {
namespace {

std::int64_t area(const Rect& rect) { return std::int64_t{rect.width()} * rect.height(); }

}  // namespace

RunResult execute(const Program& program, FrameState& state, const TileSource& source,
                  const TileSink& sink, const ExecuteOptions& options, RunStatus& status) {
  const auto start = std::chrono::steady_clock::now();
  RunResult result;
  const auto finish = [&] {
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  };

  // Compute what holds for the whole frame.
  program.kernel->run_frame(state, status);
  if (status.failed_check >= 0) {
    result = {RunEnd::failed, status.failed_check, -1, -1, 0};
    return finish();
  }
  if (status.cancel) {
    result.end = RunEnd::cancelled;
    return finish();
  }

  // Run the tiles.
  const Tiling tiling(options.window, options.tile_width, options.tile_height);
  BatchPlan plan;
  plan.batches = tiling.count();
  plan.capacity = tiling.largest();
  plan.count = [&](std::int64_t tile) { return area(tiling.rect(tile)); };
  plan.fill = [&](std::int64_t tile, std::span<float* const> planes) {
    const Rect rect = tiling.rect(tile);
    source({rect, area(rect), planes});
  };
  plan.compute = [&](std::int64_t tile, std::span<float* const> inputs,
                     std::span<float* const> outputs, Scratch& scratch, RunStatus& batch) {
    const Rect rect = tiling.rect(tile);
    run_tile(program, state, batch, scratch, inputs, outputs, rect.width(), rect.height());
  };
  plan.drain = [&](std::int64_t tile, std::span<float* const> planes) {
    const Rect rect = tiling.rect(tile);
    sink({rect, area(rect), planes});
  };
  plan.ordered = options.ordered_sink;
  plan.memory_limit = options.memory_limit;
  plan.threads = options.threads;
  plan.progress = options.progress;
  const BatchEnd end = run_batches(program, state, plan, status);

  // Turn the place of a failure into a pixel.
  result.end = end.end;
  result.failed_check = end.failed_check;
  if (end.end == RunEnd::failed) {
    const Rect rect = tiling.rect(end.failed_batch);
    result.x = rect.x0 + static_cast<int>(end.failed_sample % rect.width());
    result.y = rect.y0 + static_cast<int>(end.failed_sample / rect.width());
  }
  return finish();
}

}  // namespace pse
