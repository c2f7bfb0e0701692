// A oneTBB pipeline of three stages (next batch, fill and compute, drain) with a fixed set of
// buffers, a watcher thread that passes on cancellation, and one that reports progress.
#include "stream/batches.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

#include "stream/planes.h"

namespace pse {
namespace {

using namespace std::chrono_literals;
constexpr auto watch_interval = 5ms;
constexpr auto report_interval = 50ms;

// Working memory of one batch in flight.
struct Slot {
  Planes inputs, outputs;
  Scratch scratch;
  RunStatus status;
  std::int64_t batch = 0;
};

class Run {
 public:
  Run(const Program& program, const FrameState& state, const BatchPlan& plan, RunStatus& status)
      : program_(program),
        state_(state),
        plan_(plan),
        status_(status),
        threads_(thread_count(plan.threads)) {
    make_slots();
  }

  BatchEnd go() {
    {
      const std::jthread watcher([this](std::stop_token stop) { watch(stop); });
      std::jthread reporter;
      if (plan_.progress) reporter = std::jthread([this](std::stop_token stop) { report(stop); });
      run_pipeline();
    }
    if (thrown_) std::rethrow_exception(thrown_);
    if (end_.failed_check >= 0) {
      end_.end = RunEnd::failed;
      status_.failed_check = end_.failed_check;
      status_.failed_sample = static_cast<std::uint32_t>(end_.failed_sample);
    } else if (drained_ < plan_.batches) {
      end_.end = RunEnd::cancelled;
    } else if (plan_.progress) {
      plan_.progress(1.0);
    }
    return end_;
  }

 private:
  // One set of buffers per batch in flight: a thread each, and some more where finished batches
  // wait for their turn.
  void make_slots() {
    const ir::Module& module = program_.module();
    std::vector<bool> used(module.inputs.size());
    for (std::size_t i = 0; i < used.size(); ++i)
      used[i] = module.inputs[i].rate == ir::Rate::sample;
    const std::vector<bool> all(module.outputs.size(), true);

    const std::size_t bytes =
        Planes::bytes(used, plan_.capacity) + Planes::bytes(all, plan_.capacity);
    std::int64_t count = threads_ * (plan_.ordered ? 4 : 1);
    if (plan_.memory_limit > 0)
      count = std::min(
          count, static_cast<std::int64_t>(plan_.memory_limit / std::max<std::size_t>(bytes, 1)));
    count = std::clamp<std::int64_t>(count, 1, std::max<std::int64_t>(plan_.batches, 1));

    for (std::int64_t i = 0; i < count; ++i) {
      auto slot = std::make_unique<Slot>();
      slot->inputs = Planes(used, plan_.capacity);
      slot->outputs = Planes(all, plan_.capacity);
      free_.push_back(slot.get());
      slots_.push_back(std::move(slot));
    }
  }

  void run_pipeline() {
    namespace tbb = oneapi::tbb;
    // More threads than processors only run when oneTBB is told so.
    const tbb::global_control more(tbb::global_control::max_allowed_parallelism,
                                   static_cast<std::size_t>(std::max(threads_, thread_count(0))));
    tbb::task_arena arena(threads_);
    const auto last =
        plan_.ordered ? tbb::filter_mode::serial_in_order : tbb::filter_mode::parallel;
    arena.execute([&] {
      tbb::parallel_pipeline(
          slots_.size(),
          tbb::make_filter<void, Slot*>(
              tbb::filter_mode::serial_in_order,
              [this](tbb::flow_control& control) { return next(control); }) &
              tbb::make_filter<Slot*, Slot*>(tbb::filter_mode::parallel,
                                             [this](Slot* slot) { return compute(*slot), slot; }) &
              tbb::make_filter<Slot*, void>(last, [this](Slot* slot) { drain(*slot); }));
    });
  }

  Slot* next(oneapi::tbb::flow_control& control) {
    if (skipped(next_batch_) || next_batch_ == plan_.batches) {
      control.stop();
      return nullptr;
    }
    const std::lock_guard lock(mutex_);
    Slot* slot = free_.back();  // the one used last: its memory is still in a cache
    free_.pop_back();
    slot->batch = next_batch_++;
    return slot;
  }

  void compute(Slot& slot) {
    if (skipped(slot.batch)) return;
    guard([&] {
      plan_.fill(slot.batch, slot.inputs.pointers());
      if (plan_.compute)
        plan_.compute(slot.batch, slot.inputs.pointers(), slot.outputs.pointers(), slot.scratch,
                      slot.status);
      else
        program_.kernel->run_samples(state_, slot.status, slot.scratch,
                                     slot.inputs.pointers().data(),
                                     slot.outputs.pointers().data(), plan_.count(slot.batch));
      if (slot.status.failed_check >= 0) fail(slot);
    });
  }

  void drain(Slot& slot) {
    if (!skipped(slot.batch)) {
      guard([&] {
        plan_.drain(slot.batch, slot.outputs.pointers());
        ++drained_;
      });
    }
    const std::lock_guard lock(mutex_);
    free_.push_back(&slot);
  }

  // Runs `work`; its exception stops the run and is kept for the caller.
  template <class Work>
  void guard(Work work) {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!thrown_) thrown_ = std::current_exception();
      stop_ = true;
    }
  }

  // A batch failed: later ones need not run, but earlier ones may still fail and must be let
  // finish.
  void fail(const Slot& slot) {
    const std::lock_guard lock(mutex_);
    if (slot.batch >= first_failed_) return;
    end_ = {RunEnd::failed, slot.status.failed_check, slot.batch, slot.status.failed_sample};
    first_failed_ = slot.batch;
  }

  bool skipped(std::int64_t batch) const {
    return stop_ || status_.stopped() || batch >= first_failed_;
  }

  // Cancellation reaches the kernels through each slot's own status, so that a failure in one batch
  // leaves the place of a failure in another alone.
  void watch(const std::stop_token& stop) {
    every(watch_interval, stop, [this] {
      if (stop_ || status_.stopped())
        for (const auto& slot : slots_) slot->status.cancel = true;
    });
  }

  // Apart from watch(), because a report may take its time: it may write a snapshot.
  void report(const std::stop_token& stop) {
    every(report_interval, stop, [this] {
      if (stop_ || status_.stopped()) return;
      guard([&] {
        plan_.progress(static_cast<double>(drained_) / static_cast<double>(plan_.batches));
      });
    });
  }

  template <class Work>
  static void every(std::chrono::milliseconds interval, const std::stop_token& stop, Work work) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      wake.wait_for(lock, stop, interval, [] { return false; });
      if (!stop.stop_requested()) work();
    }
  }

  const Program& program_;
  const FrameState& state_;
  const BatchPlan& plan_;
  RunStatus& status_;
  const int threads_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::vector<Slot*> free_;
  std::mutex mutex_;  // of free_, end_ and thrown_
  std::exception_ptr thrown_;
  BatchEnd end_;
  std::int64_t next_batch_ = 0;  // touched by the first stage only
  std::atomic<std::int64_t> drained_{0};
  std::atomic<std::int64_t> first_failed_{std::numeric_limits<std::int64_t>::max()};
  std::atomic<bool> stop_{false};
};

}  // namespace

int thread_count(int wanted) {
  return wanted > 0 ? wanted : std::max(1, oneapi::tbb::info::default_concurrency());
}

BatchEnd run_batches(const Program& program, const FrameState& state, const BatchPlan& plan,
                     RunStatus& status) {
  return Run(program, state, plan, status).go();
}

}  // namespace pse
