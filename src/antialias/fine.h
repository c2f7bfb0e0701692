// Noise that is finer than a pixel, which no number of edges tells of: where the place that it is
// asked at moves by about half a lattice cell and more from pixel to pixel, a sample in the pixel's
// middle tells little of the pixel's mean. That is the high variance of the 2002 chapter, "More
// Detailed Description"; it is known beforehand here, by the program's derivative.
#pragma once

#include <vector>

#include "ir/module.h"
#include "passes/emit.h"
#include "passes/slice.h"
#include "stream/sample_source.h"

namespace pse::antialias {

struct Decisions;

// Calls of the main function whose results may change within a pixel: noise, and sines and cosines
// that no decision is computed from, since an edge of waves is an edge.
struct Noises {
  // By their first result: those whose fineness is cheap to tell.
  std::vector<bool> told;
  // Whether there are others. Those in loops whose number of turns differs from sample to sample,
  // as that of rays does, are left as they are.
  bool others = false;
};

// Fineness is dear to tell of what is asked at places that are made of other noise, or that do not
// come from a flat picture. Values have their rates; `decided`: what jumps are computed from.
Noises find_noise(const ir::Module& module, const Decisions& decisions, const InputChanges& changes,
                  const passes::Slice& decided);

// Likewise of the instructions with one result that are wanted, those whose slopes are cheap to
// tell.
std::vector<bool> find_cheap(const ir::Module& module, const Decisions& decisions,
                             const InputChanges& changes, const std::vector<bool>& wanted);

// How far the place of a call of noise moves from pixel to pixel, squared, in lattice cells: along
// the rows or the columns, whichever is more. A wave's period counts as 1.3 cells. Asks by `slope`
// instructions.
ir::Value move_squared(const passes::Emit& emit, const ir::Module& module,
                       const ir::Instruction& call);

// What moves by less is told well enough by its neighbours (smooth.h). What moves by more than the
// second is fine: samples in pixels' middles tell nothing of each other. Above the third, samples
// half a pixel apart do not either (half_grid.h).
inline constexpr float least_move_squared = 0.09f, most_move_squared = 0.2f,
                       most_half_move_squared = 0.75f;
// Where it is not told: what neighbours deviate by decides then.
inline constexpr float untold_move_squared = 0.15f;

}  // namespace pse::antialias
