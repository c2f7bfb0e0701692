// The arithmetic of ranges. See the header.
#include "passes/range.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace pse::passes {

using ir::Op;
using ir::Type;

namespace {

constexpr double low_int = -2147483648.0, high_int = 2147483647.0;

float f(double value) { return static_cast<float>(value); }

Range truth(bool can_be_false, bool can_be_true) {
  return {can_be_false ? 0.0 : 1.0, can_be_true ? 1.0 : 0.0, false};
}

// From values at the corners; a NaN among them means that nothing is known.
Range from_corners(std::initializer_list<float> corners, bool nan) {
  Range range{*corners.begin(), *corners.begin(), nan};
  for (const float corner : corners) {
    if (std::isnan(corner)) return full_range(Type::f32);
    range.lo = std::min(range.lo, double{corner});
    range.hi = std::max(range.hi, double{corner});
  }
  return range;
}

Range add(const Range& a, const Range& b) {
  // Infinities of both signs may meet.
  const bool clash =
      (std::isinf(a.lo) || std::isinf(a.hi)) && (std::isinf(b.lo) || std::isinf(b.hi));
  if (clash) return full_range(Type::f32);
  return from_corners({f(a.lo) + f(b.lo), f(a.hi) + f(b.hi)}, a.nan || b.nan);
}

Range negate(const Range& a) { return {-a.hi, -a.lo, a.nan}; }

Range multiply(const Range& a, const Range& b) {
  if (!a.is_finite() || !b.is_finite()) return full_range(Type::f32);
  return from_corners({f(a.lo) * f(b.lo), f(a.lo) * f(b.hi), f(a.hi) * f(b.lo), f(a.hi) * f(b.hi)},
                      a.nan || b.nan);
}

Range divide(const Range& a, const Range& b) {
  if (!a.is_finite() || !b.is_finite() || b.contains(0)) return full_range(Type::f32);
  return from_corners({f(a.lo) / f(b.lo), f(a.lo) / f(b.hi), f(a.hi) / f(b.lo), f(a.hi) / f(b.hi)},
                      a.nan || b.nan);
}

Range fused(const Range& a, const Range& b, const Range& c) {
  if (!a.is_finite() || !b.is_finite() || !c.is_finite()) return full_range(Type::f32);
  const auto at = [](double x, double y, double z) { return std::fma(f(x), f(y), f(z)); };
  return from_corners(
      {at(a.lo, b.lo, c.lo), at(a.lo, b.hi, c.lo), at(a.hi, b.lo, c.lo), at(a.hi, b.hi, c.lo),
       at(a.lo, b.lo, c.hi), at(a.lo, b.hi, c.hi), at(a.hi, b.lo, c.hi), at(a.hi, b.hi, c.hi)},
      a.nan || b.nan || c.nan);
}

Range absolute(const Range& a) {
  const double far = std::max(std::abs(a.lo), std::abs(a.hi));
  return {a.contains(0) ? 0 : std::min(std::abs(a.lo), std::abs(a.hi)), far, a.nan};
}

// fmin and fmax give b where either is NaN.
Range minimum(const Range& a, const Range& b) {
  const Range both{std::min(a.lo, b.lo), std::min(a.hi, b.hi), b.nan};
  return a.nan || b.nan ? hull(both, b) : both;
}

Range maximum(const Range& a, const Range& b) {
  const Range both{std::max(a.lo, b.lo), std::max(a.hi, b.hi), b.nan};
  return a.nan || b.nan ? hull(both, b) : both;
}

Range root(const Range& a) {
  if (a.hi < 0) return full_range(Type::f32);
  return {std::sqrt(f(std::max(a.lo, 0.0))), std::sqrt(f(a.hi)), a.nan || a.lo < 0};
}

Range within_int(double lo, double hi) {
  if (lo < low_int || hi > high_int) return full_range(Type::i32);
  return {lo, hi, false};
}

Range multiply_int(const Range& a, const Range& b) {
  const auto [lo, hi] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
  return within_int(lo, hi);
}

Range mask(const Range& a, const Range& b) {
  // One side that is not negative bounds the result.
  if (a.lo < 0 && b.lo < 0) return full_range(Type::i32);
  if (a.lo >= 0 && b.lo >= 0) return {0, std::min(a.hi, b.hi), false};
  return {0, a.lo >= 0 ? a.hi : b.hi, false};
}

Range shift_right(const Range& a, const Range& by, bool keeps_sign) {
  if (by.lo != by.hi || by.lo < 0 || by.lo > 31) return full_range(Type::i32);
  const double scale = std::ldexp(1.0, -static_cast<int>(by.lo));
  if (a.lo >= 0 || keeps_sign) return {std::floor(a.lo * scale), std::floor(a.hi * scale), false};
  return by.lo == 0 ? full_range(Type::i32) : Range{0, std::floor(4294967295.0 * scale), false};
}

Range to_int(const Range& a) {
  const Range whole{std::trunc(a.lo), std::trunc(a.hi), false};
  const bool fits = !a.nan && whole.lo >= low_int && whole.hi <= high_int;
  return fits ? whole : full_range(Type::i32);
}

Range from_int(const Range& a) {
  // By way of integers: g++ 12 at -O3 drops the rounding of a pair of doubles to floats and back.
  const auto nearest = [](double value) {
    return static_cast<float>(static_cast<std::int32_t>(value));
  };
  return {nearest(a.lo), nearest(a.hi), false};
}

Range less(const Range& a, const Range& b, bool or_equal) {
  const bool nan = a.nan || b.nan;
  const bool surely = or_equal ? a.hi <= b.lo : a.hi < b.lo;
  const bool surely_not = or_equal ? a.lo > b.hi : a.lo >= b.hi;
  return truth(nan || !surely, !surely_not);
}

Range equal(const Range& a, const Range& b) {
  const bool surely = !a.nan && !b.nan && a.lo == a.hi && b.lo == b.hi && a.lo == b.lo;
  return truth(!surely, !(a.hi < b.lo || b.hi < a.lo));
}

Range opposite(const Range& a) { return {1 - a.hi, 1 - a.lo, false}; }

}  // namespace

Range full_range(Type type) {
  if (type == Type::i32) return {low_int, high_int, false};
  if (type == Type::boolean) return {0, 1, false};
  return {};
}

Range exactly(double value) { return std::isnan(value) ? Range{} : Range{value, value, false}; }

Range hull(const Range& a, const Range& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), a.nan || b.nan};
}

Range range_of(Op op, const Range& a, const Range& b, const Range& c, Type result) {
  switch (op) {
    case Op::fadd:
      return add(a, b);
    case Op::fsub:
      return add(a, negate(b));
    case Op::fmul:
      return multiply(a, b);
    case Op::fdiv:
      return divide(a, b);
    case Op::fma:
      return fused(a, b, c);
    case Op::fneg:
      return negate(a);
    case Op::fabs:
      return absolute(a);
    case Op::fsqrt:
      return root(a);
    case Op::fmin:
      return minimum(a, b);
    case Op::fmax:
      return maximum(a, b);
    case Op::ffloor:
      return {std::floor(a.lo), std::floor(a.hi), a.nan};
    case Op::fceil:
      return {std::ceil(a.lo), std::ceil(a.hi), a.nan};
    case Op::ftrunc:
      return {std::trunc(a.lo), std::trunc(a.hi), a.nan};
    case Op::fround:
      return {std::nearbyint(a.lo), std::nearbyint(a.hi), a.nan};
    case Op::flt:
    case Op::ilt:
      return less(a, b, false);
    case Op::fle:
    case Op::ile:
      return less(a, b, true);
    case Op::feq:
    case Op::ieq:
      return equal(a, b);
    case Op::fne:
    case Op::ine:
      return opposite(equal(a, b));
    case Op::iadd:
      return within_int(a.lo + b.lo, a.hi + b.hi);
    case Op::isub:
      return within_int(a.lo - b.hi, a.hi - b.lo);
    case Op::imul:
      return multiply_int(a, b);
    case Op::iand:
      return mask(a, b);
    case Op::ishr:
      return shift_right(a, b, false);
    case Op::isar:
      return shift_right(a, b, true);
    case Op::band:
      return {std::min(a.lo, b.lo), std::min(a.hi, b.hi), false};
    case Op::bor:
      return {std::max(a.lo, b.lo), std::max(a.hi, b.hi), false};
    case Op::bnot:
      return opposite(a);
    case Op::select:
      return a.is(1) ? b : a.is(0) ? c : hull(b, c);
    case Op::f2i:
      return to_int(a);
    case Op::i2f:
      return from_int(a);
    default:
      return full_range(result);
  }
}

}  // namespace pse::passes
