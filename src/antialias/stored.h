// Edges through stored pixels (input images, another renderer's buffers), which are known at their
// centres only: the chapter's own high-contrast filter. Each condition's value is fitted to those
// of the neighbours on the same branch, both branches are run at the pixel itself, and joined by
// the kernel's share, one conditional within the other.
#pragma once

#include "antialias/fit.h"
#include "antialias/force.h"
#include "antialias/refine.h"

namespace pse::antialias {

class StoredRefiner {
 public:
  // `known` is the picture. `program` is `shown` with open conditions (force.h); the first
  // `outputs` outputs of `shown` are wanted. `state` has its frame computed. All must outlive this.
  StoredRefiner(const Program& program, const FrameState& state, const Program& shown,
                const Options& options, std::size_t outputs, const Rect& known);

  // The pixels of a tile that change. `inputs` are the tile's, over its area.
  Refined refine(const Tile& tile, std::span<float* const> inputs, RunStatus& status,
                 Counts& counts) const;

 private:
  struct Branch;
  struct Samples;
  using Values = std::vector<std::vector<float>>;  // per output of the program, per sample
  Values run(std::span<float* const> inputs, const Samples& samples, RunStatus& status) const;
  void advance(const Branch& branch, const Values& results, std::size_t first, const Tile& tile,
               std::vector<Branch>& next, Refined& refined, std::vector<bool>& failed,
               std::vector<bool>& crossed) const;

  const Program& program_;
  const FrameState& state_;
  const Options& options_;
  const Rect known_;
  struct Condition {
    std::size_t output;
    std::uint32_t bit;
    bool is_step;
  };
  static constexpr auto nowhere = static_cast<std::size_t>(-1);
  std::vector<std::size_t> output_of_;  // per output of the picture: which of the program's
  std::vector<Condition> conditions_;   // in the program's order
  std::vector<std::size_t> from_;       // per input: which of the tile's
  std::size_t high_ = nowhere, low_ = nowhere;
};

// Gives the samples of `area` that are not in `known` the values of the nearest that are.
void extend_stored(const Rect& area, const Rect& known, std::span<float* const> planes);

}  // namespace pse::antialias
