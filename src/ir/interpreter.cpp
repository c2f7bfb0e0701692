// Running the IR one sample and one instruction at a time. See the header; the operators are in
// evaluate.h.
#include "ir/interpreter.h"

#include <algorithm>

namespace pse::ir {

ArrayMemory::ArrayMemory(const Function& function) : function_(&function) {
  std::size_t size = 0;
  for (const Array& array : function.arrays) {
    size += static_cast<std::size_t>(array.components) * static_cast<std::size_t>(array.capacity);
  }
  elements_.resize(size);
  lengths_.resize(function.arrays.size());

  float* next = elements_.data();
  for (std::size_t i = 0; i < function.arrays.size(); ++i) {
    views_.push_back({next, &lengths_[i]});
    next += static_cast<std::size_t>(function.arrays[i].components) *
            static_cast<std::size_t>(function.arrays[i].capacity);
  }
  reset();
}

void ArrayMemory::reset() {
  std::ranges::fill(elements_, 0.0f);
  for (std::size_t i = 0; i < lengths_.size(); ++i)
    lengths_[i] = function_->arrays[i].initial_length;
}

Interpreter::Interpreter(const Module& module)
    : module_(&module), frames_(module.functions.size()) {}

Outcome Interpreter::run(std::uint32_t function, std::span<const Bits> arguments,
                         const Environment& environment, std::span<Bits> results) {
  environment_ = &environment;
  entered_ = &module_->functions[function];
  turns_left_ = environment.max_turns;
  outcome_ = {};
  operations_ = 0;
  enter(function);
  Frame& frame = frames_[function];
  const Region& body = entered_->body;
  for (std::size_t i = 0; i < body.params.size(); ++i) frame[body.params[i]] = arguments[i];
  if (!run_region(body, frame)) return outcome_;
  for (std::size_t i = 0; i < body.yields.size(); ++i) results[i] = frame[body.yields[i]];
  return outcome_;
}

void Interpreter::enter(std::uint32_t function) {
  // Values of the last run need no clearing: each is defined before its uses.
  frames_[function].resize(module_->functions[function].values.size());
}

bool Interpreter::stop(End end, std::int32_t check) {
  outcome_ = {end, check};
  return false;
}

bool Interpreter::run_region(const Region& region, Frame& frame) {
  for (const Instruction& in : region.body) {
    operations_ += in.op > Op::input ? 1 : 0;
    if (is_scalar(in.op)) {
      const Value* operand = in.operands.data();
      const std::size_t count = in.operands.size();
      const Bits b = count > 1 ? frame[operand[1]] : 0;
      const Bits c = count > 2 ? frame[operand[2]] : 0;
      frame[in.results[0]] = evaluate(in.op, frame[operand[0]], b, c);
    } else if (!run_instruction(in, frame)) {
      return false;
    }
  }
  return true;
}

bool Interpreter::run_instruction(const Instruction& in, Frame& frame) {
  const auto index = static_cast<std::size_t>(in.imm);
  // Where component `component` of element `e` lies.
  const auto element = [&](std::int32_t e) -> float& {
    const auto capacity = static_cast<std::size_t>(entered_->arrays[index].capacity);
    return environment_->arrays[index]
        .planes[static_cast<std::size_t>(in.component) * capacity + static_cast<std::size_t>(e)];
  };
  switch (in.op) {
    case Op::const_f32:
    case Op::const_i32:
      frame[in.result()] = static_cast<Bits>(in.imm);
      return true;
    case Op::const_bool:
      frame[in.result()] = in.imm != 0;
      return true;
    case Op::input:
      frame[in.result()] = to_bits(environment_->inputs[index]);
      return true;
    case Op::slope:
      frame[in.result()] = to_bits(0.0f);
      return true;
    case Op::table_f32:
    case Op::table_i32:
    case Op::bytes_add:
    case Op::bytes_lookup: {
      const Bits second = in.operands.size() > 1 ? frame[in.operands[1]] : 0;
      frame[in.result()] = evaluate_table(*module_, in.op, in.imm, frame[in.operands[0]], second);
      return true;
    }
    case Op::array_load: {
      const auto e = static_cast<std::int32_t>(frame[in.operands[0]]);
      const bool inside = e >= 0 && e < *environment_->arrays[index].length;
      frame[in.result()] = inside ? to_bits(element(e)) : 0;
      return true;
    }
    case Op::array_store: {
      const auto e = static_cast<std::int32_t>(frame[in.operands[0]]);
      if (e >= 0 && e < entered_->arrays[index].capacity)
        element(e) = to_f32(frame[in.operands[1]]);
      return true;
    }
    case Op::array_length:
      frame[in.result()] = static_cast<Bits>(*environment_->arrays[index].length);
      return true;
    case Op::array_resize:
      resize_array(in, frame);
      return true;
    case Op::check:
      return frame[in.operands[0]] != 0 || stop(End::failed_check, in.imm);
    case Op::call:
      return run_call(in, frame);
    case Op::external:
      run_external(in, frame);
      return true;
    case Op::if_: {
      const Region& region = in.regions[frame[in.operands[0]] ? 0 : 1];
      if (!run_region(region, frame)) return false;
      for (std::size_t i = 0; i < in.results.size(); ++i)
        frame[in.results[i]] = frame[region.yields[i]];
      return true;
    }
    case Op::loop:
      return run_loop(in, frame);
    default:
      return true;
  }
}

bool Interpreter::run_loop(const Instruction& in, Frame& frame) {
  const Region& head = in.regions[0];
  const Region& body = in.regions[1];
  const std::size_t carried = in.operands.size();
  for (std::size_t i = 0; i < carried; ++i) frame[head.params[i]] = frame[in.operands[i]];
  while (true) {
    if (!run_region(head, frame)) return false;
    if (!frame[head.yields[0]]) break;
    if (environment_->cancel && environment_->cancel->load(std::memory_order_relaxed))
      return stop(End::cancelled);
    if (turns_left_ == 0) return stop(End::out_of_turns);
    --turns_left_;
    for (std::size_t i = 0; i < carried; ++i) frame[body.params[i]] = frame[head.params[i]];
    if (!run_region(body, frame)) return false;
    for (std::size_t i = 0; i < carried; ++i) frame[head.params[i]] = frame[body.yields[i]];
  }
  for (std::size_t i = 0; i < carried; ++i) frame[in.results[i]] = frame[head.params[i]];
  return true;
}

bool Interpreter::run_call(const Instruction& in, Frame& frame) {
  const auto callee = static_cast<std::uint32_t>(in.imm);
  const Region& body = module_->functions[callee].body;
  enter(callee);
  Frame& inner = frames_[callee];
  for (std::size_t i = 0; i < in.operands.size(); ++i)
    inner[body.params[i]] = frame[in.operands[i]];
  if (!run_region(body, inner)) return false;
  for (std::size_t i = 0; i < in.results.size(); ++i) frame[in.results[i]] = inner[body.yields[i]];
  return true;
}

void Interpreter::run_external(const Instruction& in, Frame& frame) {
  external_arguments_.clear();
  for (const Value operand : in.operands) external_arguments_.push_back(to_f32(frame[operand]));
  external_results_.assign(in.results.size(), 0.0f);
  if (environment_->external) {
    (*environment_->external)(static_cast<std::uint32_t>(in.imm), external_arguments_,
                              external_results_);
  }
  for (std::size_t i = 0; i < in.results.size(); ++i)
    frame[in.results[i]] = to_bits(external_results_[i]);
}

void Interpreter::resize_array(const Instruction& in, const Frame& frame) {
  const Array& array = entered_->arrays[static_cast<std::size_t>(in.imm)];
  const ArrayView& view = environment_->arrays[static_cast<std::size_t>(in.imm)];
  const auto wanted = static_cast<std::int32_t>(frame[in.operands[0]]);
  const std::int32_t length = std::clamp(wanted, 0, array.capacity);
  // Elements that come into being are 0.
  for (std::int32_t c = 0; c < array.components && length > *view.length; ++c) {
    float* plane =
        view.planes + static_cast<std::size_t>(c) * static_cast<std::size_t>(array.capacity);
    std::fill(plane + *view.length, plane + length, 0.0f);
  }
  *view.length = length;
}

Interpreted interpret(const Module& module, std::uint32_t function, std::span<const float> inputs,
                      const ExternalCallback* external, std::uint64_t max_turns) {
  const Function& entered = module.functions[function];
  ArrayMemory memory(entered);
  const Environment environment{
      .inputs = inputs, .arrays = memory.views(), .external = external, .max_turns = max_turns};
  Interpreted interpreted;
  interpreted.results.resize(entered.body.yields.size());
  interpreted.outcome = Interpreter(module).run(function, {}, environment, interpreted.results);
  for (std::size_t i = 0; i < interpreted.results.size(); ++i) {
    const bool is_float = entered.values[entered.body.yields[i]].type == Type::f32;
    if (is_float) interpreted.results[i] = canonical(interpreted.results[i]);
  }
  return interpreted;
}

}  // namespace pse::ir
