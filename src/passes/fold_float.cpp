// Rules for floats. Each is exact under IEEE for every operand, signed zeros and infinities
// included; a NaN's sign and payload cannot be observed. So: never x*0, x-x, and x+0 only where x
// is known not to be -0.
#include <bit>

#include "passes/folder.h"

namespace pse::passes {

using ir::Bits;
using ir::Instruction;
using ir::Op;
using ir::Value;

Folded Folder::simplify_float(Instruction& in, std::vector<Instruction>& out) {
  const Value a = in.operands[0];
  const Value b = in.operands.size() > 1 ? in.operands[1] : ir::no_value;
  // A constant of an operation that commutes stands second.
  const bool commutes = in.op == Op::fadd || in.op == Op::fmul;
  if (commutes && constant(a) && !constant(b)) {
    std::swap(in.operands[0], in.operands[1]);
    return simplify_float(in, out);
  }
  switch (in.op) {
    case Op::fadd:
      if (is_constant_f32(b, -0.0f)) return replace(a);
      if (is_constant_f32(b, 0.0f) && known(a).never_negative_zero) return replace(a);
      if (comes_from(b, Op::fneg)) return become(in, Op::fsub, {a, inner(b)});
      if (comes_from(a, Op::fneg)) return become(in, Op::fsub, {b, inner(a)});
      return keep();
    case Op::fsub:
      if (is_constant_f32(b, 0.0f)) return replace(a);
      if (is_constant_f32(b, -0.0f) && known(a).never_negative_zero) return replace(a);
      if (is_constant_f32(a, -0.0f)) return become(in, Op::fneg, {b});
      if (comes_from(b, Op::fneg)) return become(in, Op::fadd, {a, inner(b)});
      return keep();
    case Op::fmul:
      if (is_constant_f32(b, 1.0f)) return replace(a);
      if (is_constant_f32(b, -1.0f)) return become(in, Op::fneg, {a});
      if (comes_from(a, Op::fneg) && comes_from(b, Op::fneg))
        return become(in, Op::fmul, {inner(a), inner(b)});
      return keep();
    case Op::fneg:
      if (comes_from(a, Op::fneg)) return replace(inner(a));
      return keep();
    case Op::fabs:
      if (comes_from(a, Op::fabs)) return replace(a);
      if (comes_from(a, Op::fneg)) return become(in, Op::fabs, {inner(a)});
      if (comes_from(a, Op::fmul) && inner(a, 0) == inner(a, 1)) return replace(a);
      return keep();
    case Op::fmin:
    case Op::fmax:
      if (a == b) return replace(a);
      return keep();
    default:
      return keep();
  }
}

Folded Folder::simplify_division(Instruction& in, std::vector<Instruction>& out) {
  const Value a = in.operands[0], b = in.operands[1];
  if (comes_from(a, Op::fneg) && comes_from(b, Op::fneg))
    return become(in, Op::fdiv, {inner(a), inner(b)});
  const auto divisor = constant(b);
  if (!divisor) return keep();
  if (*divisor == ir::to_bits(1.0f)) return replace(a);
  if (*divisor == ir::to_bits(-1.0f)) return become(in, Op::fneg, {a});
  // Dividing by a power of two is multiplying by its reciprocal, where both are normal numbers.
  const Bits exponent = (*divisor >> 23) & 0xff;
  if ((*divisor & 0x7fffffu) != 0 || exponent < 1 || exponent > 253) return keep();
  const Bits reciprocal = ir::to_bits(1.0f / ir::to_f32(*divisor));
  return become(in, Op::fmul, {a, add_constant(out, ir::Type::f32, reciprocal, in.span)});
}

Folded Folder::simplify_fma(Instruction& in) {
  const Value a = in.operands[0], b = in.operands[1], c = in.operands[2];
  if (constant(a) && !constant(b)) {
    std::swap(in.operands[0], in.operands[1]);
    return simplify_fma(in);
  }
  // A product that rounds to zero or is zero keeps its sign when -0 is added.
  if (is_constant_f32(c, -0.0f)) return become(in, Op::fmul, {a, b});
  if (is_constant_f32(b, 1.0f)) return become(in, Op::fadd, {a, c});
  if (is_constant_f32(b, -1.0f)) return become(in, Op::fsub, {c, a});
  if (comes_from(a, Op::fneg) && comes_from(b, Op::fneg))
    return become(in, Op::fma, {inner(a), inner(b), c});
  return keep();
}

Folded Folder::simplify_rounding(Instruction& in) {
  const Value a = in.operands[0];
  const Op from = known(a).op;
  const bool is_whole =
      from == Op::ffloor || from == Op::fceil || from == Op::ftrunc || from == Op::fround;
  // An integer as a float is whole, and never -0.
  if (is_whole || from == Op::i2f) return replace(a);
  return keep();
}

Folded Folder::simplify_conversion(Instruction& in) {
  const Value a = in.operands[0];
  if (in.op == Op::f2i && comes_from(a, Op::ftrunc)) return become(in, Op::f2i, {inner(a)});
  if (in.op == Op::f2bits && comes_from(a, Op::bits2f)) return replace(inner(a));
  if (in.op == Op::bits2f && comes_from(a, Op::f2bits)) return replace(inner(a));
  return keep();
}

}  // namespace pse::passes
