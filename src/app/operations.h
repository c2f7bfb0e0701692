// Rates made visible: how many operations a program takes per constant, per frame and per sample,
// as its text says it, as the compiler leaves it, and as it runs. For `--stats` and `pse info`.
// 1985 paper, "Now What?": a compiler that "recognizes quantities that vary slowly".
#pragma once

#include "ir/count.h"
#include "stream/executor.h"

namespace pse::app {

// Constants and inputs are not operations.
struct OperationCounts {
  // Of the program with its functions put into their callers; a loop's body counts once. Those of
  // constant rate are what the compiler works out.
  ir::RateCounts written{};
  // What is left for the two functions that run; a loop's body counts once, unless it was unrolled.
  std::size_t frame = 0, sample = 0;
  // Carried out by the frame function and, on average, for a sample; every turn of a loop counts.
  double frame_run = 0, sample_run = 0;
  int samples_looked_at = 0;  // 0: the program did not run, or it runs for a scene

  // Adds what is written and compiled; of a scene all programs count.
  void add(const OperationCounts& other);
};

// For PipelineOptions::after_pass: keeps the counts of the program as written.
void count_written(std::string_view pass, const ir::Module& module, OperationCounts& counts);

void count_compiled(const passes::SplitModule& split, OperationCounts& counts);

// Runs the program by the interpreter at up to 64 pixels of the window, evenly spread, and counts.
// `state` as for execute(). Nothing is counted where the program fails or is stopped there.
void count_run(const Program& program, FrameState state, const TileSource& source,
               const Rect& window, RunStatus& status, OperationCounts& counts);

}  // namespace pse::app
