// The state of one function's folding: what is known of each value, and the rules. fold.cpp walks,
// the fold_*.cpp hold the rules by kind of operator.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ir/evaluate.h"
#include "ir/module.h"
#include "passes/rewrite.h"

namespace pse::passes {

// What is known of where a value comes from.
struct Known {
  ir::Op op = ir::Op::loop;  // loop: nothing
  std::int32_t imm = 0;
  std::array<ir::Value, 3> operands{ir::no_value, ir::no_value, ir::no_value};
  bool never_negative_zero = false;
  std::int8_t assumed = -1;  // a boolean's value within the branch being walked
};

// What became of an instruction: kept (perhaps changed), or replaced by a value that exists.
struct Folded {
  ir::Value value = ir::no_value;
  bool replaced() const { return value != ir::no_value; }
};

class Folder {
 public:
  Folder(ir::Module& module, ir::Function& function)
      : module_(module), function_(function), known_(function.values.size()) {}

  // Applies the rules to an instruction without regions whose operands are final. New constants go
  // to `out`.
  Folded simplify(ir::Instruction& in, std::vector<ir::Instruction>& out);
  // Notes a kept instruction for the rules to come.
  void note(const ir::Instruction& in);

  std::optional<ir::Bits> constant(ir::Value value) const;
  bool is_constant_f32(ir::Value value, float wanted) const {
    const auto bits = constant(value);
    return bits && *bits == ir::to_bits(wanted);
  }
  bool is_constant_i32(ir::Value value, std::int32_t wanted) const {
    const auto bits = constant(value);
    return bits && *bits == static_cast<ir::Bits>(wanted);
  }
  Known& known(ir::Value value) {
    if (value >= known_.size()) known_.resize(value + 1);
    return known_[value];
  }
  const Known& known(ir::Value value) const {
    static const Known nothing;
    return value < known_.size() ? known_[value] : nothing;
  }
  ir::Type type(ir::Value value) const { return function_.values[value].type; }

 private:
  // Fold to a constant, or to another operator on these operands.
  static Folded keep() { return {}; }
  static Folded replace(ir::Value value) { return {value}; }
  Folded become_constant(ir::Instruction& in, ir::Bits bits) const;
  Folded become(ir::Instruction& in, ir::Op op, std::vector<ir::Value> operands);
  ir::Value add_constant(std::vector<ir::Instruction>& out, ir::Type type, ir::Bits bits,
                         const Span& span);
  bool comes_from(ir::Value value, ir::Op op) const { return known(value).op == op; }
  ir::Value inner(ir::Value value, std::size_t operand = 0) const {
    return known(value).operands[operand];
  }

  std::optional<ir::Bits> evaluate_constant(const ir::Instruction& in) const;
  Folded simplify_float(ir::Instruction& in, std::vector<ir::Instruction>& out);
  Folded simplify_division(ir::Instruction& in, std::vector<ir::Instruction>& out);
  Folded simplify_fma(ir::Instruction& in);
  Folded simplify_rounding(ir::Instruction& in);
  Folded simplify_integer(ir::Instruction& in, std::vector<ir::Instruction>& out);
  Folded simplify_shift(ir::Instruction& in);
  Folded simplify_comparison(ir::Instruction& in);
  Folded simplify_boolean(ir::Instruction& in);
  Folded simplify_select(ir::Instruction& in);
  Folded simplify_conversion(ir::Instruction& in);
  Folded simplify_table(ir::Instruction& in);
  Folded gather_constants(ir::Instruction& in, std::vector<ir::Instruction>& out);
  bool never_negative_zero(const ir::Instruction& in) const;

  ir::Module& module_;
  ir::Function& function_;
  std::vector<Known> known_;
};

}  // namespace pse::passes
