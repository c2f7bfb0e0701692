// Counting by rate and by running. See the header.
#include "app/operations.h"

#include <algorithm>

#include "passes/passes.h"

namespace pse::app {
namespace {

constexpr int side = 8;  // samples looked at: side x side

}  // namespace

void OperationCounts::add(const OperationCounts& other) {
  for (std::size_t i = 0; i < written.size(); ++i) written[i] += other.written[i];
  frame += other.frame;
  sample += other.sample;
}

void count_written(std::string_view pass, const ir::Module& module, OperationCounts& counts) {
  // Without optimising there is no second chance.
  if (pass != "lower" && pass != "inline") return;
  ir::Module copy = module;
  passes::assign_rates(copy);
  counts.written = ir::count_by_rate(copy.main());
}

void count_compiled(const passes::SplitModule& split, OperationCounts& counts) {
  counts.frame = counts.sample = 0;
  for (std::uint32_t i = 0; i < split.module.functions.size(); ++i) {
    const ir::RateCounts by_rate = ir::count_by_rate(split.module.functions[i]);
    (i == split.frame ? counts.frame : counts.sample) += by_rate[0] + by_rate[1] + by_rate[2];
  }
}

void count_run(const Program& program, FrameState state, const TileSource& source,
               const Rect& window, RunStatus& status, OperationCounts& counts) {
  const ir::Module& module = program.module();
  OperationCounter counter;
  const auto kernel = make_counting_kernel(program.split, counter);
  kernel->run_frame(state, status);

  // One sample at a time, as a tile of one pixel. Planes hold whole vectors.
  constexpr std::size_t plane = 16;
  std::vector<float> inputs(module.inputs.size() * plane), outputs(module.outputs.size() * plane);
  std::vector<float*> in, out;
  for (std::size_t i = 0; i < module.inputs.size(); ++i)
    in.push_back(module.inputs[i].rate == ir::Rate::sample ? &inputs[i * plane] : nullptr);
  for (std::size_t i = 0; i < module.outputs.size(); ++i) out.push_back(&outputs[i * plane]);
  Scratch scratch;
  int looked_at = 0;
  const int columns = std::min(side, window.width()), rows = std::min(side, window.height());
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int x = window.x0 + (2 * column + 1) * window.width() / (2 * columns);
      const int y = window.y0 + (2 * row + 1) * window.height() / (2 * rows);
      source({.rect = {x, y, x + 1, y + 1}, .count = 1, .planes = in});
      kernel->run_samples(state, status, scratch, in.data(), out.data(), 1);
      if (status.cancel || status.failed_check >= 0) return status.failed_check = -1, void();
      ++looked_at;
    }
  }
  counts.frame_run = static_cast<double>(counter.frame);
  counts.sample_run = looked_at > 0 ? static_cast<double>(counter.sample) / looked_at : 0;
  counts.samples_looked_at = looked_at;
}

}  // namespace pse::app
