// Intervals of numbers that are not known until the program runs: the arithmetic of passes/range.h
// as instructions. Generic in the number type: with IrFloat it writes a program that computes
// bounds, with float it computes them. Moore, "Interval Analysis", 1966.
//
// An interval holds every value that a float of the program can have. It may hold NaN if and only
// if it is [-infinity, infinity]; its ends are never NaN. Rounding to nearest is monotonic, so the
// ends come out of the operator itself and nothing is widened for it.
#pragma once

#include "noise/number.h"

namespace pse::bounds {

// The vocabulary of plain numbers; values that write IR bring their own.
using num::abs;
using num::both;
using num::choose;
using num::either;
using num::fma;
using num::max;
using num::min;
using num::negate;
using num::select;

template <class F>
struct Interval {
  F lo, hi;
};

// Anything, NaN too.
template <class F>
Interval<F> anything() {
  return {F(-num::infinity), F(num::infinity)};
}

template <class F>
num::BoolOf<F> may_be_nan(const Interval<F>& a) {
  return both(a.lo == -num::infinity, a.hi == num::infinity);
}

// Ends that came out as NaN: anything may be between them.
template <class F>
Interval<F> checked(const F& lo, const F& hi) {
  return {select(lo == lo, lo, F(-num::infinity)), select(hi == hi, hi, F(num::infinity))};
}
// `a` where `good`, else anything.
template <class F>
Interval<F> provided(const num::BoolOf<F>& good, const Interval<F>& a) {
  return {select(good, a.lo, F(-num::infinity)), select(good, a.hi, F(num::infinity))};
}
template <class F>
Interval<F> hull(const Interval<F>& a, const Interval<F>& b) {
  return {min(a.lo, b.lo), max(a.hi, b.hi)};
}
// Moved outward by a part of the ends and a little more, for functions that err by some ulps.
template <class F>
Interval<F> widened(const Interval<F>& a, float part = 0x1p-20f, float more = 1e-30f) {
  return {a.lo - fma(abs(a.lo), F(part), F(more)), a.hi + fma(abs(a.hi), F(part), F(more))};
}

template <class F>
Interval<F> operator-(const Interval<F>& a) {
  return {-a.hi, -a.lo};
}
template <class F>
Interval<F> operator+(const Interval<F>& a, const Interval<F>& b) {
  return checked(a.lo + b.lo, a.hi + b.hi);
}
template <class F>
Interval<F> operator-(const Interval<F>& a, const Interval<F>& b) {
  return checked(a.lo - b.hi, a.hi - b.lo);
}

// Between the least and the greatest of four; anything where one of them is NaN or two are opposite
// infinities.
template <class F>
Interval<F> around(const F& p, const F& q, const F& r, const F& s) {
  const F sum = (p + q) + (r + s);
  return provided(sum == sum, Interval<F>{min(min(p, q), min(r, s)), max(max(p, q), max(r, s))});
}
template <class F>
Interval<F> around(const F& p, const F& q) {
  const F sum = p + q;
  return provided(sum == sum, Interval<F>{min(p, q), max(p, q)});
}

// A product with infinite ends may hide 0 * infinity between them.
template <class F>
Interval<F> operator*(const Interval<F>& a, const Interval<F>& b) {
  const Interval<F> product = around(a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi);
  const auto finite = [](const Interval<F>& x) {
    return both(x.lo > -num::infinity, x.hi < num::infinity);
  };
  return provided(both(finite(a), finite(b)), product);
}
// By a number that is known.
template <class F>
Interval<F> times(const Interval<F>& a, const F& b) {
  return around(a.lo * b, a.hi * b);
}
template <class F>
Interval<F> square(const Interval<F>& a) {
  const F low = a.lo * a.lo, high = a.hi * a.hi;
  const auto crosses = both(a.lo<0.0f, a.hi> 0.0f);
  return provided(negate(may_be_nan(a)),
                  Interval<F>{select(crosses, F(0.0f), min(low, high)), max(low, high)});
}
// a * b + c with one rounding.
template <class F>
Interval<F> fused(const Interval<F>& a, const Interval<F>& b, const Interval<F>& c) {
  const auto finite = [](const Interval<F>& x) {
    return both(x.lo > -num::infinity, x.hi < num::infinity);
  };
  const auto ends = [&](const F& sum) {
    return around(fma(a.lo, b.lo, sum), fma(a.lo, b.hi, sum), fma(a.hi, b.lo, sum),
                  fma(a.hi, b.hi, sum));
  };
  return provided(both(both(finite(a), finite(b)), finite(c)),
                  Interval<F>{ends(c.lo).lo, ends(c.hi).hi});
}
template <class F>
Interval<F> fused(const Interval<F>& a, const F& b, const Interval<F>& c) {
  const Interval<F> low = around(fma(a.lo, b, c.lo), fma(a.hi, b, c.lo));
  const Interval<F> high = around(fma(a.lo, b, c.hi), fma(a.hi, b, c.hi));
  return {low.lo, high.hi};
}
template <class F>
Interval<F> fused_square(const Interval<F>& a, const Interval<F>& c) {
  const auto crosses = both(a.lo<0.0f, a.hi> 0.0f);
  const F near = select(crosses, F(0.0f), min(abs(a.lo), abs(a.hi)));
  const F far = max(abs(a.lo), abs(a.hi));
  return provided(negate(may_be_nan(a)), checked(fma(near, near, c.lo), fma(far, far, c.hi)));
}
template <class F>
Interval<F> operator/(const Interval<F>& a, const Interval<F>& b) {
  const auto apart = either(b.lo > 0.0f, b.hi < 0.0f);
  return provided(apart, around(a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi));
}

template <class F>
Interval<F> abs(const Interval<F>& a) {
  const auto crosses = both(a.lo<0.0f, a.hi> 0.0f);
  const F low = abs(a.lo), high = abs(a.hi);
  return provided(negate(may_be_nan(a)),
                  Interval<F>{select(crosses, F(0.0f), min(low, high)), max(low, high)});
}
// The second operand where either is NaN.
template <class F>
Interval<F> min(const Interval<F>& a, const Interval<F>& b) {
  return provided(negate(may_be_nan(b)), checked(min(a.lo, b.lo), min(a.hi, b.hi)));
}
template <class F>
Interval<F> max(const Interval<F>& a, const Interval<F>& b) {
  return provided(negate(may_be_nan(b)), checked(max(a.lo, b.lo), max(a.hi, b.hi)));
}

}  // namespace pse::bounds
