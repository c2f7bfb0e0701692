// Writes instructions behind others while a function's regions are rebuilt one by one. (ir::Builder
// writes functions from nothing.)
#pragma once

#include <bit>
#include <initializer_list>
#include <vector>

#include "ir/module.h"

namespace pse::passes {

class Emit {
 public:
  Emit(ir::Function& function, std::vector<ir::Instruction>& out)
      : function_(&function), out_(&out) {}

  ir::Value operator()(ir::Op op, std::initializer_list<ir::Value> operands, std::int32_t imm = 0,
                       std::int32_t component = 0) const {
    // The type of a choice is that of what is chosen.
    const char letter = ir::info(op).results.front();
    const ir::Type type = letter == 'f'   ? ir::Type::f32
                          : letter == 'i' ? ir::Type::i32
                          : letter == 'b' ? ir::Type::boolean
                                          : function_->values[*(operands.end() - 1)].type;
    const ir::Value result = function_->add_value(type);
    out_->push_back(
        {.op = op, .operands = operands, .results = {result}, .imm = imm, .component = component});
    return result;
  }
  void effect(ir::Op op, std::initializer_list<ir::Value> operands, std::int32_t imm,
              std::int32_t component = 0) const {
    out_->push_back({.op = op, .operands = operands, .imm = imm, .component = component});
  }
  ir::Value number(float value) const {
    return (*this)(ir::Op::const_f32, {}, std::bit_cast<std::int32_t>(value));
  }
  ir::Value integer(std::int32_t value) const { return (*this)(ir::Op::const_i32, {}, value); }

  ir::Value add(ir::Value a, ir::Value b) const { return (*this)(ir::Op::fadd, {a, b}); }
  ir::Value sub(ir::Value a, ir::Value b) const { return (*this)(ir::Op::fsub, {a, b}); }
  ir::Value mul(ir::Value a, ir::Value b) const { return (*this)(ir::Op::fmul, {a, b}); }
  ir::Value div(ir::Value a, ir::Value b) const { return (*this)(ir::Op::fdiv, {a, b}); }
  ir::Value less(ir::Value a, ir::Value b) const { return (*this)(ir::Op::flt, {a, b}); }
  ir::Value choose(ir::Value condition, ir::Value yes, ir::Value no) const {
    return (*this)(ir::Op::select, {condition, yes, no});
  }

  ir::Function& function() const { return *function_; }
  std::vector<ir::Instruction>& out() const { return *out_; }

 private:
  ir::Function* function_;
  std::vector<ir::Instruction>* out_;
};

}  // namespace pse::passes
