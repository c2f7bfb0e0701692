// Rules for integers, booleans, choices and tables: all exact, as integers wrap.
#include <algorithm>

#include "passes/folder.h"

namespace pse::passes {

using ir::Bits;
using ir::Instruction;
using ir::Op;
using ir::Value;

Folded Folder::simplify_integer(Instruction& in, std::vector<Instruction>& out) {
  const Value a = in.operands[0], b = in.operands[1];
  if (in.op != Op::isub && constant(a) && !constant(b)) {
    std::swap(in.operands[0], in.operands[1]);
    return simplify_integer(in, out);
  }
  switch (in.op) {
    case Op::isub:
      if (a == b) return become_constant(in, 0);
      if (is_constant_i32(b, 0)) return replace(a);
      // x - c is x + -c, so that constants gather.
      if (const auto bits = constant(b)) {
        in.op = Op::iadd;
        in.operands[1] = add_constant(out, ir::Type::i32, 0u - *bits, in.span);
        return gather_constants(in, out);
      }
      return keep();
    case Op::iadd:
      if (is_constant_i32(b, 0)) return replace(a);
      return gather_constants(in, out);
    case Op::imul:
      if (is_constant_i32(b, 1)) return replace(a);
      if (is_constant_i32(b, 0)) return replace(b);
      return gather_constants(in, out);
    case Op::iand:
      if (a == b || is_constant_i32(b, -1)) return replace(a);
      if (is_constant_i32(b, 0)) return replace(b);
      return gather_constants(in, out);
    case Op::ior:
      if (a == b || is_constant_i32(b, 0)) return replace(a);
      if (is_constant_i32(b, -1)) return replace(b);
      return gather_constants(in, out);
    case Op::ixor:
      if (a == b) return become_constant(in, 0);
      if (is_constant_i32(b, 0)) return replace(a);
      return gather_constants(in, out);
    default:
      return keep();
  }
}

// (x op c1) op c2 is x op (c1 op c2) for the operators of integers that associate.
Folded Folder::gather_constants(Instruction& in, std::vector<Instruction>& out) {
  const auto second = constant(in.operands[1]);
  const Known& first = known(in.operands[0]);
  if (!second || first.op != in.op) return keep();
  const auto earlier = constant(first.operands[1]);
  if (!earlier) return keep();
  const Value x = first.operands[0];
  const Bits both = ir::evaluate(in.op, *earlier, *second, 0);
  in.operands = {x, add_constant(out, ir::Type::i32, both, in.span)};
  return keep();
}

Folded Folder::simplify_shift(Instruction& in) {
  const auto by = constant(in.operands[1]);
  if (by && *by == 0) return replace(in.operands[0]);
  if (by && *by > 31 && in.op != Op::isar) return become_constant(in, 0);
  return keep();
}

Folded Folder::simplify_comparison(Instruction& in) {
  if (in.operands[0] != in.operands[1]) return keep();
  switch (in.op) {
    case Op::flt:  // also false for NaN
    case Op::ine:
    case Op::ilt:
      return become_constant(in, 0);
    case Op::ieq:
    case Op::ile:
      return become_constant(in, 1);
    case Op::fle:
      return become(in, Op::feq, in.operands);
    default:
      return keep();  // feq and fne of a value with itself ask for NaN
  }
}

Folded Folder::simplify_boolean(Instruction& in) {
  const Value a = in.operands[0];
  if (in.op == Op::bnot) {
    const Known& from = known(a);
    const auto operands = [&] { return std::vector<Value>{from.operands[0], from.operands[1]}; };
    switch (from.op) {
      case Op::bnot:
        return replace(from.operands[0]);
      case Op::feq:
        return become(in, Op::fne, operands());
      case Op::fne:
        return become(in, Op::feq, operands());
      case Op::ieq:
        return become(in, Op::ine, operands());
      case Op::ine:
        return become(in, Op::ieq, operands());
      case Op::ilt:
        return become(in, Op::ile, {from.operands[1], from.operands[0]});
      case Op::ile:
        return become(in, Op::ilt, {from.operands[1], from.operands[0]});
      default:
        return keep();  // flt and fle have no opposite: both are false for NaN
    }
  }
  const Value b = in.operands[1];
  if (constant(a) && !constant(b)) {
    std::swap(in.operands[0], in.operands[1]);
    return simplify_boolean(in);
  }
  const auto second = constant(b);
  switch (in.op) {
    case Op::band:
      if (a == b || second == Bits{1}) return replace(a);
      if (second == Bits{0}) return become_constant(in, 0);
      return keep();
    case Op::bor:
      if (a == b || second == Bits{0}) return replace(a);
      if (second == Bits{1}) return become_constant(in, 1);
      return keep();
    default:
      if (a == b) return become_constant(in, 0);
      if (second == Bits{0}) return replace(a);
      if (second == Bits{1}) return become(in, Op::bnot, {a});
      return keep();
  }
}

Folded Folder::simplify_select(Instruction& in) {
  const Value condition = in.operands[0], yes = in.operands[1], no = in.operands[2];
  if (yes == no) return replace(yes);
  if (const auto known_condition = constant(condition)) return replace(*known_condition ? yes : no);
  if (comes_from(condition, Op::bnot)) {
    in.operands = {inner(condition), no, yes};
    return simplify_select(in);
  }
  if (type(yes) == ir::Type::boolean) {
    const auto first = constant(yes), second = constant(no);
    if (first == Bits{1} && second == Bits{0}) return replace(condition);
    if (first == Bits{0} && second == Bits{1}) return become(in, Op::bnot, {condition});
    if (first == Bits{1} || yes == condition) return become(in, Op::bor, {condition, no});
    if (second == Bits{0} || no == condition) return become(in, Op::band, {condition, yes});
    return keep();
  }
  const auto first = constant(yes), second = constant(no);
  if (first && second && *first == *second) return replace(yes);
  return keep();
}

Folded Folder::simplify_table(Instruction& in) {
  if (in.op == Op::bytes_add) {
    if (is_constant_i32(in.operands[1], 0)) return replace(in.operands[0]);
    if (is_constant_i32(in.operands[0], 0)) return replace(in.operands[1]);
    return keep();
  }
  if (in.op == Op::bytes_lookup || !comes_from(in.operands[0], Op::iand)) return keep();
  // The index is taken modulo the size anyway.
  const auto index = static_cast<std::size_t>(in.imm);
  const std::size_t size = in.op == Op::table_f32 ? module_.float_tables[index].entries.size()
                                                  : module_.int_tables[index].entries.size();
  const auto mask = constant(inner(in.operands[0], 1));
  if (mask && (*mask & (size - 1)) == size - 1) in.operands[0] = inner(in.operands[0]);
  return keep();
}

}  // namespace pse::passes
