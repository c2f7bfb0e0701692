// A program run over a list of samples instead of a rectangle, and who is whose neighbour in such a
// list. Antialiasing by neighbours (2002 chapter, "Antialiased rendering of procedural textures")
// cuts a program into segments at its conditionals. Each segment runs over the samples that take
// its side, the values that are live where segments meet lie in planes, and a filter compares each
// sample's value with its neighbours' before the list is split again.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/executor.h"

namespace pse {

struct Sample {
  std::int32_t x = 0, y = 0;  // on the grid of samples; x right, y down
  std::int64_t at = 0;        // its place in the planes
  friend bool operator==(const Sample&, const Sample&) = default;
};

using SampleList = std::vector<Sample>;

// All samples of a rectangle in row-major order, as they lie in the planes of a tile.
SampleList samples_of(const Rect& rect);

// The samples of `list` where plane[sample.at] is not 0 (`wanted` true) or is 0 (false), in the
// same order.
SampleList select_samples(const SampleList& list, const float* plane, bool wanted);

enum class Neighbour : std::uint8_t {
  left,
  right,
  up,
  down,
  up_left,
  up_right,
  down_left,
  down_right
};
inline constexpr std::size_t neighbour_count = 8;

// For each sample of a list, where in the list its eight neighbours stand; -1 for those not in it.
class NeighbourTable {
 public:
  explicit NeighbourTable(const SampleList& list);
  std::int32_t of(std::size_t sample, Neighbour which) const {
    return table_[sample][static_cast<std::size_t>(which)];
  }
  std::size_t size() const { return table_.size(); }

 private:
  std::vector<std::array<std::int32_t, neighbour_count>> table_;
};

struct ListOptions {
  int threads = 0;  // 0: as many as the machine has
  int batch = 1024;
};

struct ListResult {
  RunEnd end = RunEnd::finished;
  std::int32_t failed_check = -1;
  std::size_t failed_sample = 0;  // when failed: index in the list
};

// Runs `segment` once for each sample: input i is inputs[i][sample.at] (those of rate frame come
// from `state`; null is allowed there), output o goes to outputs[o][sample.at] (null: not wanted).
// No two samples may share a place. The frame function is not run: call run_frame once before. The
// result does not depend on threads, batch or the list's order, and places that are not in the list
// are left alone.
ListResult run_list(const Program& segment, const FrameState& state, const SampleList& list,
                    std::span<const float* const> inputs, std::span<float* const> outputs,
                    const ListOptions& options, RunStatus& status);

}  // namespace pse
