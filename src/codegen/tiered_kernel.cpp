// A kernel in two tiers: the first draws at once; if that goes on for as long as LLVM would take to
// compile, LLVM does so meanwhile, and takes over. Both give the same bits, so that it does not
// matter which samples are whose.
#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "codegen/behind.h"
#include "codegen/kernel.h"
#include "ir/count.h"

namespace pse {
namespace {

// LLVM's time for one operation of the IR. To have waited as long costs at most twice what the best
// choice would have cost, whenever the run ends.
constexpr std::int64_t llvm_ns_per_operation = 60'000;

// The optimised kernel once it is there.
struct Optimised {
  std::unique_ptr<const Kernel> kernel;
  std::atomic<const Kernel*> ready{nullptr};
};

class TieredKernel final : public Kernel {
 public:
  // Without `split` the first tier stays alone.
  TieredKernel(std::unique_ptr<const Kernel> first,
               std::shared_ptr<const passes::SplitModule> split, CodegenOptions options)
      : first_(std::move(first)), split_(std::move(split)), options_(std::move(options)) {
    if (split_) {
      const auto operations = static_cast<std::int64_t>(ir::count_instructions(split_->module));
      patience_ns_ = operations * llvm_ns_per_operation;
    }
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
    if (const Kernel* ready = optimised_->ready.load(std::memory_order_acquire)) {
      ++optimised_runs_;
      return ready->run_samples(state, status, scratch, inputs, outputs, count);
    }
    const auto start = std::chrono::steady_clock::now();
    first_->run_samples(state, status, scratch, inputs, outputs, count);
    ++first_runs_;
    const std::chrono::nanoseconds spent = std::chrono::steady_clock::now() - start;
    if ((spent_ns_ += spent.count()) > patience_ns_ && split_) compile();
  }

  TierRuns tier_runs() const override { return {first_runs_, optimised_runs_}; }

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
  mutable std::atomic<std::int64_t> spent_ns_{0}, first_runs_{0}, optimised_runs_{0};
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
  return std::make_unique<TieredKernel>(std::move(*first), tier == Tier::first ? nullptr : split,
                                        options);
}

}  // namespace pse
