// The plain scalar interpreter of the IR: the definition of what a program means. Compiled kernels
// and passes are tested against it bit for bit.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "ir/evaluate.h"
#include "ir/module.h"

namespace pse::ir {

// One array's memory: component c of element e is planes[c * capacity + e].
struct ArrayView {
  float* planes = nullptr;
  std::int32_t* length = nullptr;
};

// Memory for all arrays of a function, as they are before a run.
class ArrayMemory {
 public:
  explicit ArrayMemory(const Function& function);
  std::span<const ArrayView> views() const { return views_; }
  // Back to the initial lengths, with elements of 0.
  void reset();

 private:
  const Function* function_;
  std::vector<float> elements_;
  std::vector<std::int32_t> lengths_;
  std::vector<ArrayView> views_;
};

using ExternalCallback = std::function<void(
    std::uint32_t external, std::span<const float> arguments, std::span<float> results)>;

// What a run may read and write besides its arguments.
struct Environment {
  std::span<const float> inputs;               // one per Module::inputs
  std::span<const ArrayView> arrays;           // one per Function::arrays of the function run
  const ExternalCallback* external = nullptr;  // none: externals give 0
  const std::atomic<bool>* cancel = nullptr;   // polled by every turn of a loop
  std::uint64_t max_turns =
      std::numeric_limits<std::uint64_t>::max();  // turns of all loops together
};

enum class End : std::uint8_t { finished, failed_check, cancelled, out_of_turns };

struct Outcome {
  End end = End::finished;
  std::int32_t check = -1;  // index into Module::checks where one failed
};

// Runs functions of one module. Keeps a frame of values per function, so a run allocates nothing;
// not for sharing between threads. The module must pass the verifier.
class Interpreter {
 public:
  explicit Interpreter(const Module& module);

  // `results` gets the function's yields as they are (NaN as computed) where the run finished.
  Outcome run(std::uint32_t function, std::span<const Bits> arguments,
              const Environment& environment, std::span<Bits> results);
  // Operations that the last run carried out, every turn of a loop counted; without constants and
  // inputs, as count_by_rate() counts (ir/count.h).
  std::uint64_t operations() const { return operations_; }

 private:
  using Frame = std::vector<Bits>;

  void enter(std::uint32_t function);
  bool run_region(const Region& region, Frame& frame);
  bool run_instruction(const Instruction& in, Frame& frame);
  bool run_loop(const Instruction& in, Frame& frame);
  bool run_call(const Instruction& in, Frame& frame);
  void run_external(const Instruction& in, Frame& frame);
  void resize_array(const Instruction& in, const Frame& frame);
  bool stop(End end, std::int32_t check = -1);

  const Module* module_;
  const Environment* environment_ = nullptr;
  const Function* entered_ = nullptr;  // the function whose arrays are bound
  std::vector<Frame> frames_;          // per function; calls do not recurse, so one each is enough
  std::vector<float> external_arguments_;
  std::vector<float> external_results_;
  std::uint64_t turns_left_ = 0;
  std::uint64_t operations_ = 0;
  Outcome outcome_;
};

// For tests and single runs: one function with fresh arrays. Float results have the one NaN.
struct Interpreted {
  Outcome outcome;
  std::vector<Bits> results;
};
Interpreted interpret(const Module& module, std::uint32_t function, std::span<const float> inputs,
                      const ExternalCallback* external = nullptr,
                      std::uint64_t max_turns = std::numeric_limits<std::uint64_t>::max());

}  // namespace pse::ir
