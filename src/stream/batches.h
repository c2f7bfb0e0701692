// The engine under the executor: runs a kernel over numbered batches of samples on several threads,
// each batch in buffers of its own. execute() gives it the tiles of an image, run_list() pieces of
// a list of samples.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "stream/program.h"

namespace pse {

enum class RunEnd { finished, cancelled, failed };

// What to run. Batches are started in the order of their numbers.
struct BatchPlan {
  std::int64_t batches = 0;
  std::int64_t capacity = 0;  // the largest count of any batch
  std::function<std::int64_t(std::int64_t batch)> count;
  // Writes the planes of sample-rate inputs (the others are null). Called from several threads at
  // once.
  std::function<void(std::int64_t batch, std::span<float* const> inputs)> fill;
  // What is done with a filled batch; empty: the kernel is run on it. `status` is the batch's own:
  // cancelled with the run, and a failed check there ends the run.
  std::function<void(std::int64_t batch, std::span<float* const> inputs,
                     std::span<float* const> outputs, Scratch& scratch, RunStatus& status)>
      compute;
  // Takes the results. Called from several threads at once unless `ordered`.
  std::function<void(std::int64_t batch, std::span<float* const> outputs)> drain;
  bool ordered = false;          // drain gets the batches one at a time and in order
  std::size_t memory_limit = 0;  // bytes of buffers alive at once; 0: what keeps the threads busy
  int threads = 0;               // 0: as many as the machine has
  std::function<void(double done)>
      progress;  // 0..1, from one thread at a time, at most 20 times a second
};

struct BatchEnd {
  RunEnd end = RunEnd::finished;
  std::int32_t failed_check = -1;
  std::int64_t failed_batch = 0;  // the first failed batch by number, whatever the threads did
  std::int64_t failed_sample = 0;
};

// Exceptions of fill and drain end the run and are thrown again from here. `state` must hold a
// computed frame.
BatchEnd run_batches(const Program& program, const FrameState& state, const BatchPlan& plan,
                     RunStatus& status);

// Threads that a run uses when asked for `wanted` (0: all that this process may use).
int thread_count(int wanted);

}  // namespace pse
