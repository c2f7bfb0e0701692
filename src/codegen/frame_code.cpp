// When to interpret, when to compile, and the call of what was compiled.
#include "codegen/frame_code.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "codegen/interpreted_frame.h"
#include "ir/count.h"

namespace pse {
namespace {

// About what one compilation costs, in microseconds of interpreting and in operations.
constexpr std::int64_t patience_us = 20'000;
constexpr std::size_t patience_operations = 500'000;

void mark_called(const ir::Module& module, const ir::Region& region, std::vector<bool>& used) {
  for (const ir::Instruction& in : region.body) {
    for (const ir::Region& inner : in.regions) mark_called(module, inner, used);
    if (in.op != ir::Op::call || used[static_cast<std::size_t>(in.imm)]) continue;
    used[static_cast<std::size_t>(in.imm)] = true;
    mark_called(module, module.functions[static_cast<std::size_t>(in.imm)].body, used);
  }
}

// The module without the bodies that the frame does not need; all numbers stay.
passes::SplitModule frame_part(const passes::SplitModule& split) {
  std::vector<bool> used(split.module.functions.size());
  used[split.frame] = true;
  mark_called(split.module, split.module.functions[split.frame].body, used);
  passes::SplitModule part;
  part.frame = split.frame;
  part.first_slot = split.first_slot;
  ir::Module& module = part.module;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) {
      module.functions.push_back(split.module.functions[i]);
    } else {
      module.functions.emplace_back().name = split.module.functions[i].name;
    }
  }
  module.entry = split.module.entry;
  module.float_tables = split.module.float_tables;
  module.int_tables = split.module.int_tables;
  module.byte_tables = split.module.byte_tables;
  module.inputs = split.module.inputs;
  module.externals = split.module.externals;
  return part;
}

}  // namespace

FrameCode::FrameCode(const passes::SplitModule& split, Compile compile, bool compile_at_once)
    : part_(frame_part(split)),
      compile_(std::move(compile)),
      max_turns_(patience_operations / (ir::count_instructions(part_.module) + 1)),
      layout_(part_.module.functions[part_.frame].arrays),
      wanted_(compile_at_once) {}

void FrameCode::run(FrameState& state, RunStatus& status) const {
  if (!wanted_) {
    const auto start = std::chrono::steady_clock::now();
    const bool finished = interpret_frame(part_, state, status, max_turns_);
    const auto spent = std::chrono::duration_cast<std::chrono::microseconds>(
        std::chrono::steady_clock::now() - start);
    if ((spent_us_ += spent.count()) > patience_us) wanted_ = true;
    if (finished) return;
    wanted_ = true;
  }
  if (const KernelEntry entry = compiled(status)) {
    run_compiled(entry, state, status);
  } else {
    interpret_frame(part_, state, status);
  }
}

KernelEntry FrameCode::compiled(const RunStatus& status) const {
  std::call_once(once_, [this] {
    code_ = std::async(std::launch::async, [this] { return compile_(part_); }).share();
  });
  // LLVM cannot be interrupted, but whoever waits for it can.
  while (code_.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready)
    if (status.stopped()) return nullptr;
  const std::optional<CodeObject>& code = code_.get();
  if (!code) return nullptr;
  return reinterpret_cast<KernelEntry>(const_cast<void*>(code->find(frame_symbol)));
}

void FrameCode::run_compiled(KernelEntry entry, FrameState& state, RunStatus& status) const {
  const ir::Function& function = part_.module.functions[part_.frame];
  state.uniforms.resize(part_.module.inputs.size());
  state.arrays.assign(static_cast<std::size_t>(layout_.size), 0.0f);
  state.array_lengths.clear();
  for (const ir::Array& array : function.arrays)
    state.array_lengths.push_back(array.initial_length);
  std::vector<float> slots(function.body.yields.size());
  float* const outputs[] = {slots.data()};
  KernelCall call;
  call.outputs = outputs;
  call.count = 1;
  call.uniforms = state.uniforms.data();
  call.frame_arrays = state.arrays.data();
  call.frame_lengths = state.array_lengths.data();
  call.cancel = &status.stop();
  call.externals = state.externals.data();
  entry(&call);
  report(call, status, 0);
  std::ranges::copy(slots, state.uniforms.begin() + static_cast<std::ptrdiff_t>(part_.first_slot));
}

void report(const KernelCall& call, RunStatus& status, std::int64_t first) {
  if (call.failed_check < 0) return;
  report_failure(status, call.failed_check, static_cast<std::uint32_t>(first + call.failed_sample));
}

}  // namespace pse
