// --stats: where the time and memory of a run went.
#pragma once

#include <string>

#include "antialias/refine.h"
#include "app/operations.h"
#include "stream/program.h"

namespace pse::app {

struct RunStats {
  CompileTimes compile;
  OperationCounts operations;
  int width = 0, threads = 0;  // vector width; threads used
  int frames = 0;
  TierSamples tier_samples;     // by which tier, those for antialiasing as well
  antialias::Counts antialias;  // pixels, of all frames
  double samples = 0;
  double compute_seconds =
      0;  // in the executor, with reading tiles and handing them to the writers
  double total_seconds = 0;
};

// The operations as a table of a line each for written, compiled and run, each line indented.
std::string operations_text(const OperationCounts& counts, std::string_view indent);
std::string stats_text(const RunStats& stats);
std::string stats_json(const RunStats& stats);

}  // namespace pse::app
