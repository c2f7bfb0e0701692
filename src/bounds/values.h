// What stands for a value of the program in the program of its bounds.
#pragma once

#include "bounds/functions.h"

namespace pse::bounds {

// A value that does not depend on the place is `exact` and itself. Of the others, a number lies in
// `range`; a truth value is true at some places where `may`, at all where `must`; of an integer
// nothing is known.
struct Bound {
  bool exact = true;
  ir::Type type = ir::Type::f32;
  Range range;       // exact: both ends the number
  IrBool must, may;  // exact: both the truth value
  IrInt integer;     // exact only
};

inline Bound exact_bound(ir::Builder& builder, ir::Value value) {
  Bound bound{.type = builder.type(value)};
  if (bound.type == ir::Type::f32) bound.range = {{builder, value}, {builder, value}};
  if (bound.type == ir::Type::boolean) bound.must = bound.may = {builder, value};
  if (bound.type == ir::Type::i32) bound.integer = {builder, value};
  return bound;
}
inline Bound exact_number(float value) { return {.range = {IrFloat(value), IrFloat(value)}}; }
inline Bound between(const Range& range) { return {.exact = false, .range = range}; }
inline Bound truth(const IrBool& must, const IrBool& may) {
  return {.exact = false, .type = ir::Type::boolean, .must = must, .may = may};
}
// Nothing is known.
inline Bound unknown(ir::Type type) {
  Bound bound{.exact = false, .type = type, .range = anything<IrFloat>()};
  bound.must = IrBool(false), bound.may = IrBool(true);
  return bound;
}
// Of no place at all: the hull with another is the other.
inline Bound nowhere(ir::Type type) {
  Bound bound{.exact = false, .type = type};
  bound.range = {IrFloat(num::infinity), IrFloat(-num::infinity)};
  bound.must = IrBool(true), bound.may = IrBool(false);
  return bound;
}
// The ends of a number; an exact one may be NaN.
inline Range ends_of(const Bound& bound) {
  return bound.exact ? checked(bound.range.lo, bound.range.hi) : bound.range;
}
inline Bound hull(const Bound& a, const Bound& b) {
  Bound bound{.exact = false, .type = a.type};
  if (a.type == ir::Type::f32) bound.range = hull(ends_of(a), ends_of(b));
  if (a.type == ir::Type::boolean)
    bound.must = both(a.must, b.must), bound.may = either(a.may, b.may);
  return bound;
}

// An exact value as a value of the program.
inline ir::Value value_of(ir::Builder& builder, const Bound& bound) {
  if (bound.type == ir::Type::f32) return place(builder, bound.range.lo);
  if (bound.type == ir::Type::boolean) return place(builder, bound.must);
  return place(builder, bound.integer);
}
// A bound as two values, nothing for integers; and back.
inline void append_ends(ir::Builder& builder, const Bound& bound, std::vector<ir::Value>& values) {
  if (bound.type == ir::Type::f32) {
    const Range ends = ends_of(bound);
    values.push_back(place(builder, ends.lo));
    values.push_back(place(builder, ends.hi));
  } else if (bound.type == ir::Type::boolean) {
    values.push_back(place(builder, bound.must));
    values.push_back(place(builder, bound.may));
  }
}
inline std::size_t count_ends(ir::Type type) { return type == ir::Type::i32 ? 0 : 2; }
inline Bound from_ends(ir::Builder& builder, ir::Type type, const ir::Value* ends) {
  if (type == ir::Type::f32) return between({{builder, ends[0]}, {builder, ends[1]}});
  if (type == ir::Type::boolean) return truth({builder, ends[0]}, {builder, ends[1]});
  return unknown(type);
}

}  // namespace pse::bounds
