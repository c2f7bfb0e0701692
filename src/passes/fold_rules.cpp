// Constants, and the choice of the rule by operator. See folder.h.
#include "passes/folder.h"

namespace pse::passes {

using ir::Bits;
using ir::Instruction;
using ir::Op;
using ir::Value;

std::optional<Bits> Folder::constant(Value value) const {
  const Known& what = known(value);
  if (is_constant(what.op)) return static_cast<Bits>(what.imm);
  if (what.assumed >= 0) return static_cast<Bits>(what.assumed);
  return {};
}

void Folder::note(const Instruction& in) {
  if (in.results.size() != 1 || has_regions(in.op) || is_call(in.op)) return;
  Known& what = known(in.result());
  what.op = in.op;
  what.imm = in.op == Op::const_bool ? in.imm != 0 : in.imm;
  for (std::size_t i = 0; i < in.operands.size() && i < 3; ++i) what.operands[i] = in.operands[i];
  what.never_negative_zero = never_negative_zero(in);
}

// Whether the result can never be -0, so that adding +0 to it changes nothing.
bool Folder::never_negative_zero(const Instruction& in) const {
  const auto never = [&](std::size_t operand) {
    return known(in.operands[operand]).never_negative_zero;
  };
  switch (in.op) {
    case Op::const_f32:
      return static_cast<Bits>(in.imm) != 0x80000000u;
    case Op::fabs:
    case Op::i2f:
      return true;
    // A sum is -0 only where both are; a difference only where the first is -0 and the second +0.
    case Op::fadd:
      return never(0) || never(1);
    case Op::fsub:
      return never(0);
    case Op::fmul:
      return in.operands[0] == in.operands[1];
    case Op::select:
      return type(in.result()) == ir::Type::f32 && never(1) && never(2);
    default:
      return false;
  }
}

Folded Folder::become_constant(Instruction& in, Bits bits) const {
  const ir::Type result = type(in.result());
  in.op = result == ir::Type::f32   ? Op::const_f32
          : result == ir::Type::i32 ? Op::const_i32
                                    : Op::const_bool;
  // Every NaN is the same value; one spelling makes the text the same on every machine.
  in.imm = static_cast<std::int32_t>(result == ir::Type::f32 ? ir::canonical(bits) : bits);
  in.operands.clear();
  return keep();
}

Folded Folder::become(Instruction& in, Op op, std::vector<Value> operands) {
  in.op = op;
  in.imm = 0;
  in.operands = std::move(operands);
  return keep();
}

Value Folder::add_constant(std::vector<Instruction>& out, ir::Type type, Bits bits,
                           const Span& span) {
  const Op op = type == ir::Type::f32   ? Op::const_f32
                : type == ir::Type::i32 ? Op::const_i32
                                        : Op::const_bool;
  const Value value = function_.add_value(type);
  out.push_back(
      {.op = op, .results = {value}, .imm = static_cast<std::int32_t>(bits), .span = span});
  note(out.back());
  return value;
}

std::optional<Bits> Folder::evaluate_constant(const Instruction& in) const {
  Bits operands[3] = {};
  for (std::size_t i = 0; i < in.operands.size(); ++i) {
    const auto bits = constant(in.operands[i]);
    if (!bits) return {};
    operands[i] = *bits;
  }
  if (ir::is_scalar(in.op)) return ir::evaluate(in.op, operands[0], operands[1], operands[2]);
  return ir::evaluate_table(module_, in.op, in.imm, operands[0], operands[1]);
}

Folded Folder::simplify(Instruction& in, std::vector<Instruction>& out) {
  const bool has_value =
      ir::is_scalar(in.op) || (in.op >= Op::table_f32 && in.op <= Op::bytes_lookup);
  if (!has_value) return keep();
  if (const auto bits = evaluate_constant(in)) return become_constant(in, *bits);
  switch (in.op) {
    case Op::fdiv:
      return simplify_division(in, out);
    case Op::fma:
      return simplify_fma(in);
    case Op::ffloor:
    case Op::fceil:
    case Op::ftrunc:
    case Op::fround:
      return simplify_rounding(in);
    case Op::ishl:
    case Op::ishr:
    case Op::isar:
      return simplify_shift(in);
    case Op::band:
    case Op::bor:
    case Op::bxor:
    case Op::bnot:
      return simplify_boolean(in);
    case Op::select:
      return simplify_select(in);
    case Op::f2i:
    case Op::i2f:
    case Op::f2bits:
    case Op::bits2f:
      return simplify_conversion(in);
    default:
      break;
  }
  if (in.op >= Op::fadd && in.op <= Op::fmax) return simplify_float(in, out);
  if ((in.op >= Op::feq && in.op <= Op::fle) || (in.op >= Op::ieq && in.op <= Op::ile)) {
    return simplify_comparison(in);
  }
  if (in.op >= Op::iadd && in.op <= Op::ixor) return simplify_integer(in, out);
  return simplify_table(in);
}

}  // namespace pse::passes
