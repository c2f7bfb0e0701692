// One operator after the other. Where both operands are the same value, a product is a square and
// a difference 0.
#include "bounds/operators.h"

#include <algorithm>

namespace pse::bounds {
namespace {

using ir::Op;

// Both are numbers and equal at the same places.
Bound equal(const Bound& a, const Bound& b) {
  const Range &p = a.range, &q = b.range;
  const IrBool must = both(both(p.lo == p.hi, q.lo == q.hi), p.lo == q.lo);
  return truth(must, both(p.lo <= q.hi, q.lo <= p.hi));
}
Bound negated(const Bound& a) { return truth(negate(a.may), negate(a.must)); }

Range product(const ir::Instruction& in, std::span<const Bound> a) {
  if (in.operands[0] == in.operands[1]) return square(a[0].range);
  if (a[1].exact) return times(a[0].range, a[1].range.lo);
  if (a[0].exact) return times(a[1].range, a[0].range.lo);
  return a[0].range * a[1].range;
}
Range fused_product(const ir::Instruction& in, std::span<const Bound> a) {
  if (in.operands[0] == in.operands[1]) return fused_square(a[0].range, a[2].range);
  if (a[1].exact) return fused(a[0].range, a[1].range.lo, a[2].range);
  if (a[0].exact) return fused(a[1].range, a[0].range.lo, a[2].range);
  return fused(a[0].range, a[1].range, a[2].range);
}

Bound choice(std::span<const Bound> a) {
  const Bound &yes = a[1], &no = a[2];
  const Range p = ends_of(yes), q = ends_of(no);
  if (a[0].exact) {
    const IrBool& c = a[0].must;
    Bound bound{.exact = false, .type = yes.type};
    if (yes.type == ir::Type::f32) bound.range = {select(c, p.lo, q.lo), select(c, p.hi, q.hi)};
    const auto pick = [&](const IrBool& then, const IrBool& otherwise) {
      return either(both(c, then), both(negate(c), otherwise));
    };
    if (yes.type == ir::Type::boolean)
      bound.must = pick(yes.must, no.must), bound.may = pick(yes.may, no.may);
    return bound;
  }
  if (yes.type == ir::Type::i32) return unknown(yes.type);
  // Where the box decides, one side alone.
  const Bound either_side = hull(yes, no);
  if (yes.type == ir::Type::boolean) return either_side;
  const auto decided = [&](const IrFloat& then, const IrFloat& no_then, const IrFloat& any) {
    return select(a[0].must, then, select(a[0].may, any, no_then));
  };
  return between(
      {decided(p.lo, q.lo, either_side.range.lo), decided(p.hi, q.hi, either_side.range.hi)});
}

// Whatever the entry.
Range any_entry(const ir::FloatTable& table) {
  const auto [low, high] = std::ranges::minmax(table.entries);
  return {IrFloat(low), IrFloat(high)};
}

}  // namespace

Bound bound_operator(const ir::Module& module, const ir::Instruction& in,
                     std::span<const Bound> a) {
  const auto each = [&](auto&& f) { return between({f(a[0].range.lo), f(a[0].range.hi)}); };
  switch (in.op) {
    case Op::fadd:
      return between(a[0].range + a[1].range);
    case Op::fsub:
      // Infinity less itself is NaN, so only of what is finite.
      if (in.operands[0] == in.operands[1]) {
        const IrFloat zero(0.0f);
        return between(
            provided(a[0].range.hi - a[0].range.lo < IrFloat(num::infinity), Range{zero, zero}));
      }
      return between(a[0].range - a[1].range);
    case Op::fmul:
      return between(product(in, a));
    case Op::fdiv:
      return between(a[0].range / a[1].range);
    case Op::fma:
      return between(fused_product(in, a));
    case Op::fneg:
      return between(-a[0].range);
    case Op::fabs:
      return between(abs(a[0].range));
    case Op::fsqrt:
      return between(around(sqrt(a[0].range.lo), sqrt(a[0].range.hi)));
    case Op::fmin:
      return between(min(a[0].range, a[1].range));
    case Op::fmax:
      return between(max(a[0].range, a[1].range));
    case Op::ffloor:
      return each([](const IrFloat& x) { return floor(x); });
    case Op::fceil:
      return each([](const IrFloat& x) { return ceil(x); });
    case Op::ftrunc:
      return each([](const IrFloat& x) { return trunc(x); });
    case Op::fround:
      return each([](const IrFloat& x) { return round(x); });
    // NaN alone differs from itself.
    case Op::feq:
      if (in.operands[0] == in.operands[1])
        return truth(negate(may_be_nan(a[0].range)), IrBool(true));
      return equal(a[0], a[1]);
    case Op::fne:
      if (in.operands[0] == in.operands[1]) return truth(IrBool(false), may_be_nan(a[0].range));
      return negated(equal(a[0], a[1]));
    case Op::flt:
      return truth(a[0].range.hi < a[1].range.lo, a[0].range.lo < a[1].range.hi);
    case Op::fle:
      return truth(a[0].range.hi <= a[1].range.lo, a[0].range.lo <= a[1].range.hi);
    case Op::band:
      return truth(both(a[0].must, a[1].must), both(a[0].may, a[1].may));
    case Op::bor:
      return truth(either(a[0].must, a[1].must), either(a[0].may, a[1].may));
    case Op::bnot:
      return negated(a[0]);
    case Op::select:
      return choice(a);
    case Op::table_f32:
      return between(any_entry(module.float_tables[static_cast<std::size_t>(in.imm)]));
    default:
      break;
  }
  const char letter = ir::info(in.op).results.front();
  return unknown(letter == 'f' ? ir::Type::f32 : letter == 'i' ? ir::Type::i32 : ir::Type::boolean);
}

}  // namespace pse::bounds
