// A program run over a lattice, its outputs gathered as grids. Blocks without matter are never
// allocated, so memory grows with what is there and not with the box.
#pragma once

#include <functional>

#include "stream/batches.h"
#include "volume/lattice.h"
#include "volume/vdb.h"

namespace pse::volume {

// A grid and the module outputs that feed it, one per component.
struct BakedGrid {
  GridSpec spec;
  std::vector<std::size_t> outputs;
  float band = 0;  // of a level set: how far distances are kept, in metres
};

struct BakeOptions {
  int threads = 0;                                     // 0: as many as the machine has
  std::size_t memory_limit = std::size_t{8} << 30;     // bytes of grids
  bool stop_at_not_finite = false;                     // NaN or infinity ends the run
  std::function<void(double done)> progress;
};

struct BakeResult {
  RunEnd end = RunEnd::finished;
  std::int32_t failed_check = -1;
  std::array<double, 3> failed_at{};  // where a check failed
  bool out_of_memory = false;         // the limit was reached
  double estimate = 0;                // bytes, where they were so far above it that nothing was run
  std::int64_t not_finite = 0;        // values that were NaN or infinite; stored as background
  std::size_t not_finite_grid = 0;    // of the first one
  std::array<double, 3> not_finite_at{};
  std::int64_t active = 0;  // voxels with matter
  bool cut = false;         // matter touches the box
  double seconds = 0;
};

// Matter is where the grid called `density` is above 0; without one, where any value is not 0, or
// within the band of a level set. The state must have its uniforms and externals set; this runs the
// frame function. The grids do not depend on threads. Where they might not fit into the memory, some
// blocks tell first about how much all will take.
BakeResult bake(const Program& program, FrameState& state, const Lattice& lattice,
                const std::vector<BakedGrid>& grids, GridWriter& writer,
                const BakeOptions& options, RunStatus& status);

}  // namespace pse::volume
