// A kernel in two tiers: the first draws at once; if that goes on for as long as LLVM would take to
// compile, LLVM does so meanwhile, and takes over. Both give the same bits, so that it does not
// matter which samples are whose.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <span>
#include <utility>

#include "codegen/behind.h"
#include "codegen/interpreted_frame.h"
#include "codegen/kernel.h"
#include "ir/count.h"

namespace pse {
namespace {

// LLVM's time for one operation of the IR. To have waited as long costs at most twice what the best
// choice would have cost, whenever the run ends.
constexpr std::int64_t llvm_ns_per_operation = 60'000;

// Samples between two looks at whether the other kernel is ready; whole vectors.
constexpr std::int64_t piece = 1024;

// The arrays of a call, from some sample on.
class Planes {
 public:
  Planes(const ir::Module& module, const float* const* inputs, float* const* outputs)
      : all_inputs_(inputs, module.inputs.size()),
        all_outputs_(outputs, module.outputs.size()),
        inputs_(module.inputs.size()),
        outputs_(module.outputs.size()) {}

  const float* const* inputs(std::int64_t first) {
    for (std::size_t i = 0; i < inputs_.size(); ++i)
      inputs_[i] = all_inputs_[i] != nullptr ? all_inputs_[i] + first : nullptr;
    return inputs_.data();
  }
  float* const* outputs(std::int64_t first) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) outputs_[i] = all_outputs_[i] + first;
    return outputs_.data();
  }

 private:
  std::span<const float* const> all_inputs_;
  std::span<float* const> all_outputs_;
  std::vector<const float*> inputs_;
  std::vector<float*> outputs_;
};

// The optimised kernel once it is there.
struct Optimised {
  std::unique_ptr<const Kernel> kernel;
  std::atomic<const Kernel*> ready{nullptr};
};

class TieredKernel final : public Kernel {
 public:
  // `alone`: LLVM never comes.
  TieredKernel(std::unique_ptr<const Kernel> first,
               std::shared_ptr<const passes::SplitModule> split, CodegenOptions options, bool alone)
      : first_(std::move(first)), split_(std::move(split)), options_(std::move(options)) {
    const auto operations = static_cast<std::int64_t>(ir::count_instructions(split_->module));
    patience_ns_ =
        alone ? std::numeric_limits<std::int64_t>::max() : operations * llvm_ns_per_operation;
  }

  int width() const override {
    const Kernel* ready = optimised_->ready.load(std::memory_order_acquire);
    return ready != nullptr ? ready->width() : first_->width();
  }

  void run_frame(FrameState& state, RunStatus& status) const override {
    first_->run_frame(state, status);
  }

  void run_samples(const FrameState& state, RunStatus& status, Scratch& scratch,
                   const float* const* inputs, float* const* outputs,
                   std::int64_t count) const override {
    Planes planes(split_->module, inputs, outputs);
    for (std::int64_t first = 0; first < count; first += piece) {
      const Kernel* ready = optimised_->ready.load(std::memory_order_acquire);
      const std::int64_t here = ready != nullptr ? count - first : std::min(piece, count - first);
      // A failure is told by its place in the piece.
      RunStatus own;
      own.outer = &status;
      const auto run = [&](const Kernel& kernel, std::atomic<std::int64_t>& samples) {
        kernel.run_samples(state, own, scratch, planes.inputs(first), planes.outputs(first), here);
        samples += here;
      };
      if (ready != nullptr) {
        run(*ready, optimised_samples_);
      } else {
        const auto start = std::chrono::steady_clock::now();
        run(*first_, first_samples_);
        const std::chrono::nanoseconds spent = std::chrono::steady_clock::now() - start;
        if ((spent_ns_ += spent.count()) > patience_ns_) compile();
      }
      if (own.failed_check >= 0) {
        report_failure(status, own.failed_check,
                       own.failed_sample + static_cast<std::uint32_t>(first));
        return;
      }
      if (ready != nullptr || status.stopped()) return;
    }
  }

  TierSamples tier_samples() const override { return {first_samples_, optimised_samples_}; }

 private:
  // Once, behind the back of whoever calls; not if nobody wants the kernel when its turn comes.
  void compile() const {
    std::call_once(compiling_, [this] {
      run_behind([split = split_, options = options_, optimised = optimised_] {
        if (optimised.use_count() == 1) return;
        auto made = compile_kernel(*split, options);
        if (!made) return;
        optimised->kernel = std::move(*made);
        optimised->ready.store(optimised->kernel.get(), std::memory_order_release);
      });
    });
  }

  std::unique_ptr<const Kernel> first_;
  std::shared_ptr<const passes::SplitModule> split_;
  CodegenOptions options_;
  std::int64_t patience_ns_ = 0;
  std::shared_ptr<Optimised> optimised_ = std::make_shared<Optimised>();
  mutable std::once_flag compiling_;
  mutable std::atomic<std::int64_t> spent_ns_{0}, first_samples_{0}, optimised_samples_{0};
};

}  // namespace

std::expected<std::unique_ptr<Kernel>, std::string> make_kernel(
    std::shared_ptr<const passes::SplitModule> split, const CodegenOptions& options, Tier tier,
    CodegenStats* stats) {
  if (tier == Tier::optimised) return compile_kernel(*split, options, stats);
  if (tier == Tier::automatic) {
    CodegenOptions only_cached = options;
    only_cached.only_cached = true;
    if (auto cached = compile_kernel(*split, only_cached, stats)) return cached;
  }
  auto first = make_first_kernel(*split, options, stats);
  if (!first) return compile_kernel(*split, options, stats);
  return std::make_unique<TieredKernel>(std::move(*first), split, options, tier == Tier::first);
}

}  // namespace pse
