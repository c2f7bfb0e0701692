// The kernel's calling convention: what compiled programs look like to whoever runs them. No LLVM
// here. Fifth stage of the flow: a SplitModule becomes a Kernel; stream/ runs it over batches of
// samples.
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "passes/pipeline.h"

namespace pse {

// A function of the host, called for `count` samples at once: argument a of sample i is
// arguments[a][i], likewise results. It must be pure and thread-safe, and must treat samples
// independently. One without results may keep what it is told, and must not mind being told twice.
struct ExternalFunction {
  void (*call)(void* user, std::int64_t count, const float* const* arguments,
               float* const* results) = nullptr;
  void* user = nullptr;
};

// What is constant while a frame is computed. One per run, shared by all threads.
struct FrameState {
  std::vector<float>
      uniforms;               // one float per Module::inputs entry; those of rate sample are unused
  std::vector<float> arrays;  // arrays of rate frame, laid out by ArrayLayout
  std::vector<std::int32_t> array_lengths;  // one per Array
  std::vector<ExternalFunction> externals;  // one per Module::externals
};

// How a run ended early. `check` is the index of the first failed Module::checks entry seen, or -1.
struct RunStatus {
  std::atomic<bool> cancel{false};  // set by anyone to stop
  // The run that this one is a part of, if any: it is stopped with it, and not by itself.
  const RunStatus* outer = nullptr;
  std::atomic<std::int32_t> failed_check{-1};
  std::atomic<std::uint32_t> failed_sample{0};  // index within its batch

  // What every loop polls, at each back-edge and before each vector of samples.
  const std::atomic<bool>& stop() const { return outer != nullptr ? outer->stop() : cancel; }
  bool stopped() const { return stop().load(std::memory_order_relaxed); }
};

// One thread's working memory: sample-rate arrays. Grown by Kernel::prepare.
struct Scratch {
  std::vector<float> memory;
};

// Samples by the code that computed them.
struct TierSamples {
  std::int64_t first = 0, optimised = 0;
};

// A compiled program. Immutable and safe to share between threads.
class Kernel {
 public:
  virtual ~Kernel() = default;
  virtual int width() const = 0;
  // Runs the frame function: fills the slots at the end of state.uniforms and the arrays of rate
  // frame. state.uniforms[0 .. first_slot) and externals must be set.
  virtual void run_frame(FrameState& state, RunStatus& status) const = 0;
  // Runs the program on samples [0, count). inputs[i] is the array of Module::inputs[i] (null if
  // its rate is not sample), outputs[o] that of Module::outputs[o]. All arrays hold a multiple of
  // 16 floats, so that whole vectors may be read and written; what is written past `count` has no
  // meaning. NaN is stored as 0x7fc00000.
  virtual void run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                           const float* const* inputs, float* const* outputs,
                           std::int64_t count) const = 0;
  // So far; the interpreter counts nothing.
  virtual TierSamples tier_samples() const { return {}; }
};

// The IR interpreter behind the same interface (width 1): the meaning that every kernel is tested
// against.
std::unique_ptr<Kernel> make_interpreted_kernel(std::shared_ptr<const passes::SplitModule> split);

// Operations carried out while a kernel ran: all its frames, all its samples.
struct OperationCounter {
  std::atomic<std::uint64_t> frame{0}, sample{0};
};
// The same, counting; `counter` must live as long as the kernel.
std::unique_ptr<Kernel> make_counting_kernel(std::shared_ptr<const passes::SplitModule> split,
                                             OperationCounter& counter);

struct CodegenOptions {
  int width = 0;    // 1, 4, 8, 16, 32; 0: what this processor does best with this program
  std::string cpu;  // a name of codegen/target.h; empty: this processor
  bool optimize = true;
  bool compile_frame = false;   // the frame function as well, at once; else it is interpreted until
                                // compiling it pays
  std::filesystem::path cache;  // folder of compiled kernels by content; empty: none
  bool only_cached = false;     // fail where the cache has nothing
};

struct CodegenStats {
  double seconds = 0;
  double behind = 0;  // seconds of work by which the slowest piece exceeds the calling thread's own
  bool from_cache = false, first_tier = false;
  int width = 0;
  std::string cpu;
};

// Compiles with LLVM. The error is a sentence for the user.
std::expected<std::unique_ptr<Kernel>, std::string> compile_kernel(const passes::SplitModule& split,
                                                                   const CodegenOptions& options,
                                                                   CodegenStats* stats = nullptr);

// The first tier (first/kernel_code.h): native code within a millisecond or two, of about half the
// speed, and the same bits. The error says why there is none for this program or this processor: no
// error of the user's. Of the options only the frame function's matter.
std::expected<std::unique_ptr<Kernel>, std::string> make_first_kernel(
    const passes::SplitModule& split, const CodegenOptions& options, CodegenStats* stats = nullptr);

// Which of the two. automatic: LLVM's kernel if the cache has it; else the first tier, and once
// that has worked for as long as LLVM takes, LLVM's is compiled behind the back of whoever runs the
// kernel, and takes its place between two pieces of a call of run_samples. Where there is no first
// tier all are `optimised`.
enum class Tier : std::uint8_t { automatic, first, optimised };
std::expected<std::unique_ptr<Kernel>, std::string> make_kernel(
    std::shared_ptr<const passes::SplitModule> split, const CodegenOptions& options, Tier tier,
    CodegenStats* stats = nullptr);
// Whether LLVM still compiles for a kernel that is in use or was. A process that wants to end at
// once ends by _Exit then; by exit() or from main() it waits.
bool compiles_behind();

// `--emit llvm` and `--emit asm`.
enum class Listing { llvm, assembly };
std::expected<std::string, std::string> emit_listing(const passes::SplitModule& split,
                                                     const CodegenOptions& options,
                                                     Listing listing);

}  // namespace pse
