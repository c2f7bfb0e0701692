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

// By the first result of calls in the main function: noise that may be fine and whose fineness is
// cheap to tell. That leaves out what is asked at places that are made of other noise, or that a
// loop finds whose number of turns differs from sample to sample, or that do not come from a flat
// picture; and noise in loops which the pixel's size ends, since that is what such loops are for.
// Values have their rates.
std::vector<bool> find_noise(const ir::Module& module, const Decisions& decisions,
                             const InputChanges& changes);

// Likewise sines and cosines that no decision is computed from: an edge of waves is an edge.
std::vector<bool> find_waves(const ir::Module& module, const Decisions& decisions,
                             const InputChanges& changes, const passes::Slice& decided);

// Likewise of the instructions with one result that are wanted, those whose slopes are cheap to
// tell.
std::vector<bool> find_cheap(const ir::Module& module, const Decisions& decisions,
                             const InputChanges& changes, const std::vector<bool>& wanted);

// How far the place of a call of noise moves from pixel to pixel, squared, in lattice cells: along
// the rows or the columns, whichever is more. Asks by `slope` instructions.
ir::Value move_squared(const passes::Emit& emit, const ir::Instruction& call, bool is_wave);

// A wave is taken for noise of cells so wide in radians: between its neighbours nine samples still
// tell its mean (smooth.h) where noise is fine.
inline constexpr float cells_of_wave = 0.203f;

// Noise whose place moves by more is fine.
inline constexpr float most_move_squared = 0.2f;

}  // namespace pse::antialias
