// Writes instructions into a function, region by region. Used by lower/ and by passes that rewrite.
#pragma once

#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

#include "ir/module.h"

namespace pse::ir {

class Builder {
 public:
  Builder(Module& module, Function& function) : module_(&module), function_(&function) {
    regions_.push_back(&function.body);
  }

  Module& module() { return *module_; }
  Function& function() { return *function_; }
  Type type(Value value) const { return function_->values[value].type; }
  // The place that new instructions are reported at.
  void set_span(const Span& span) { span_ = span; }
  const Span& span() const { return span_; }
  // Instructions emitted so far; the host bounds a program's size by it.
  std::size_t emitted() const { return emitted_; }

  Value const_f32(float value);
  Value const_i32(std::int32_t value);
  Value const_bool(bool value);

  // One instruction without regions; result types follow the operator table. `imm` and `component`
  // as in Instruction.
  Value emit(Op op, std::initializer_list<Value> operands, std::int32_t imm = 0,
             std::int32_t component = 0);
  void emit_void(Op op, std::initializer_list<Value> operands, std::int32_t imm = 0,
                 std::int32_t component = 0);
  // call and external: the results have the given types.
  std::vector<Value> emit_multi(Op op, std::span<const Value> operands,
                                std::span<const Type> result_types, std::int32_t imm);

  // The same instruction, without regions, for other operands. Gives its results.
  std::vector<Value> emit_like(const Instruction& original, std::span<const Value> operands,
                               std::span<const Type> result_types);

  // Structured control. Regions are filled between begin_region and end_region, then handed to
  // emit_if / emit_loop.
  void begin_region(Region& region) { regions_.push_back(&region); }
  void end_region() { regions_.pop_back(); }
  Value add_param(Region& region, Type type);
  // Both regions must yield the same number of values of the same types.
  std::vector<Value> emit_if(Value condition, Region then_region, Region else_region);
  std::vector<Value> emit_loop(std::span<const Value> initial, Region head, Region body);

 private:
  Value append(Instruction instruction, std::span<const Type> types);

  Module* module_;
  Function* function_;
  std::vector<Region*> regions_;
  Span span_;
  std::size_t emitted_ = 0;
};

}  // namespace pse::ir
