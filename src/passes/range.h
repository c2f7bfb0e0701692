// Intervals that values lie in, and what each operator makes of them. Rounding to nearest is
// monotonic, so the ends of a result are found by the operator itself on the ends of its operands.
#pragma once

#include <cstdint>
#include <limits>

#include "ir/module.h"

namespace pse::passes {

// Of a float: between lo and hi, or NaN where `nan`. Of an integer or a boolean (0, 1): between lo
// and hi. Integers fit a double exactly.
struct Range {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  bool nan = true;

  bool is(double value) const { return lo == value && hi == value && !nan; }
  bool contains(double value) const { return lo <= value && value <= hi; }
  bool is_finite() const {
    return lo > -std::numeric_limits<double>::infinity() &&
           hi < std::numeric_limits<double>::infinity();
  }
  friend bool operator==(const Range&, const Range&) = default;
};

// Everything that a value of this type can be.
Range full_range(ir::Type type);
Range exactly(double value);
Range hull(const Range& a, const Range& b);
// The result of a scalar operator for operands within a, b, c; `result` is its type. Never too
// narrow.
Range range_of(ir::Op op, const Range& a, const Range& b, const Range& c, ir::Type result);

}  // namespace pse::passes
