// A kernel's frame function: interpreted at first, compiled once that pays. Most of what happens
// once per frame takes microseconds to interpret and tens of milliseconds to compile.
// docs/decisions/2026-11-23-compile-time.md has the numbers. Part of compiled_kernel.cpp's flow.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>

#include "codegen/array_layout.h"
#include "codegen/code_object.h"
#include "codegen/kernel.h"
#include "codegen/kernel_call.h"

namespace pse {

class FrameCode {
 public:
  // Makes the frame function's machine code; nothing where that fails.
  using Compile = std::function<std::optional<CodeObject>(const passes::SplitModule& part)>;

  FrameCode(const passes::SplitModule& split, Compile compile, bool compile_at_once);

  // Kernel::run_frame; may be called by several threads.
  void run(FrameState& state, RunStatus& status) const;

 private:
  // Starts compiling when first called, and waits for it; null: it cannot be done, or `status` is
  // stopped.
  KernelEntry compiled(const RunStatus& status) const;
  void run_compiled(KernelEntry entry, FrameState& state, RunStatus& status) const;

  passes::SplitModule part_;  // the frame function and what it calls
  Compile compile_;
  std::uint64_t max_turns_;
  FrameArrayLayout layout_;
  mutable std::atomic<bool> wanted_;               // compiled code
  mutable std::atomic<std::int64_t> spent_us_{0};  // interpreting, in all runs
  mutable std::once_flag once_;
  mutable std::shared_future<std::optional<CodeObject>> code_;  // the last: it uses the others
};

// Notes the first failed check of a call. `first` is the index of the call's first sample.
void report(const KernelCall& call, RunStatus& status, std::int64_t first);

}  // namespace pse
