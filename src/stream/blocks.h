// The order in which a tile's pixels are computed. The pixels of one vector wait for each other in
// loops that they leave at different turns, as rays do; those of a square part later than those of
// a row. Between the executors and the kernel.
#pragma once

#include <span>

#include "stream/program.h"

namespace pse {

// Runs the program on a tile of width x height samples, inputs and outputs in row-major order, as
// Kernel::run_samples does: same results, same failed check and sample. Where the samples may part,
// in squares of 8 pixels, each divided into halves and quarters for whatever the vectors hold.
void run_tile(const Program& program, const FrameState& state, RunStatus& status, Scratch& scratch,
              std::span<float* const> inputs, std::span<float* const> outputs, int width,
              int height);

}  // namespace pse
