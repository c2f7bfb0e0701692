// --stats: where the time and memory of a run went.
#pragma once

#include <string>

#include "stream/program.h"

namespace pse::app {

// Instructions of a compiled module by how often they run; loops count once.
struct OperationCounts {
  int constant = 0, frame = 0, sample = 0;
};
OperationCounts count_operations(const passes::SplitModule& split);

struct RunStats {
  CompileTimes compile;
  OperationCounts operations;
  int width = 0, threads = 0;  // vector width; threads used
  int frames = 0;
  double samples = 0;
  double compute_seconds =
      0;  // in the executor, with reading tiles and handing them to the writers
  double total_seconds = 0;
};

std::string stats_text(const RunStats& stats);
std::string stats_json(const RunStats& stats);

}  // namespace pse::app
