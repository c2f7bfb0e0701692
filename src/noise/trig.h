// Sine, cosine, tangent and their inverses. Few operations, no tables on the common path. Errors as
// in exp_log.h.
#pragma once

#include "noise/number.h"
#include "noise/tables.h"

namespace pse::num {

inline constexpr float pi = 3.14159274f, pi_rest = -8.74227766e-8f;
inline constexpr float half_pi = 1.57079637f, half_pi_rest = -4.37113883e-8f,
                       half_pi_last = -1.71512451e-15f;

// Up to here multiples of pi/2 are taken away with pi/2 in three parts; beyond, by integers.
inline constexpr float near_limit = 32768.0f;

// An angle as a whole number of quarter turns (modulo 4) and a rest in [-pi/4, pi/4], radians, and
// what the rest lost to rounding.
template <class F>
struct QuarterTurns {
  IntOf<F> whole;
  F rest, low;
};

// For |x| >= near_limit (Payne and Hanek): x = m 2^s with a whole m of 24 bits, so of 2/pi only a
// window of bits that depends on s matters modulo 4. The product of m with eight digits of 12 bits
// is exact; six of them are good.
template <class F>
std::array<F, 3> reduce_large_angle(const F& x) {
  using I = IntOf<F>;
  constexpr int digits = 8;
  const I all = bits(x);
  const I m = (all & I(0x7fffff)) | I(0x800000);
  const I m_low = m & I(0xfff), m_high = m >> I(12);
  // The window begins at bit s - 1 behind the point of 2/pi, s = exponent - 150.
  const I begin = ((all >> I(23)) & I(255)) - I(151 - two_over_pi_lead);
  std::array<I, digits> window;
  for (int k = 0; k < digits; k += 2) {
    const I two = lookup(two_over_pi, begin + I(12 * k));
    window[k] = two >> I(12);
    window[k + 1] = two & I(0xfff);
  }
  // Multiply, with carries from the last digit to the first.
  std::array<I, digits> product;
  I carry = 0;
  for (int k = digits; k-- > 0;) {
    I sum = m_low * window[k] + carry;
    if (k + 1 < digits) sum = sum + m_high * window[k + 1];
    product[k] = sum & I(0xfff);
    carry = sum >> I(12);
  }
  const auto pair = [&product](int k) { return (product[k] << I(12)) | product[k + 1]; };
  // The nearest whole number of quarter turns, and what is left in three parts of 24 bits.
  const I first = pair(0);
  const I whole = (first + I(0x200000)) >> I(22);
  const F part = to_float(first - (whole << I(22))) * 0x1p-22f;
  const F more = fma(to_float(pair(2)), F(0x1p-46f), to_float(pair(4)) * 0x1p-70f);
  const F less = fma(part, F(half_pi_rest), more * half_pi);
  const F rest = fma(part, F(half_pi), less), low = fma(part, F(half_pi), -rest) + less;
  // All of it changes sign with x; an infinite x has no angle.
  const BoolOf<F> negative = x < 0.0f;
  return {to_float(select(negative, I(0) - whole, whole)), select(negative, -rest, rest) + (x - x),
          select(negative, -low, low)};
}

// The reduction of any angle. The first product of the near case is exact with fma, and the others
// nearly.
template <class F>
QuarterTurns<F> quarter_turns(const F& x) {
  const auto [n, rest, low] = choose<3>(
      abs(x) >= near_limit, [&] { return reduce_large_angle(x); },
      [&] {
        const F turns = round(x * 0.636619747f);
        const F first = fma(turns, F(-half_pi), x);
        const F second = fma(turns, F(-half_pi_rest), first);
        const F third = fma(turns, F(-half_pi_last), second);
        // What the second product lost, from an exact difference of both sums, then the third.
        const F moved = first - second, part = moved - first;
        const F moved_rest = (first - (moved - part)) - (second + part);
        const F lost = fma(turns, F(-half_pi_rest), moved) + moved_rest;
        return std::array<F, 3>{turns, third, lost + fma(turns, F(-half_pi_last), second - third)};
      });
  return {to_int(n), rest, low};
}

// The sine of a reduced angle.
template <class F>
F sin_of(const QuarterTurns<F>& angle) {
  using I = IntOf<F>;
  const F r = angle.rest;
  const F s = r * r;
  const F sine = fma(s * r, polynomial(s, {-0.166666538f, 0.00833211653f, -0.000195100089f}), r);
  const F cosine = polynomial(s, {1.0f, -0.5f, 0.0416666456f, -0.00138873083f, 2.44320236e-05f});
  const F value = select((angle.whole & I(1)) == I(1), cosine, sine);
  return from_bits(bits(value) ^ ((angle.whole & I(2)) << I(30)));
}

// The sine of an angle in radians, of any size. Error below 1.7 ulp; keeps -0; NaN for infinities
// and NaN.
template <class F>
F sin(const F& x) {
  return select(x == 0.0f, x, sin_of(quarter_turns(x)));
}

// The cosine of an angle in radians, of any size. Error below 1.7 ulp; NaN for infinities and NaN.
template <class F>
F cos(const F& x) {
  QuarterTurns<F> angle = quarter_turns(x);
  angle.whole = angle.whole + IntOf<F>(1);
  return sin_of(angle);
}

// The tangent of an angle in radians, of any size. Error below 1.1 ulp; keeps -0; NaN for
// infinities and NaN.
template <class F>
F tan(const F& x) {
  using I = IntOf<F>;
  const QuarterTurns<F> angle = quarter_turns(x);
  const F r = angle.rest;
  const F s = r * r;
  const F above = (s * r) * polynomial(s, {0.333333522f, 0.133325905f, 0.0540675186f, 0.02124485f,
                                           0.0109296069f, -2.70353521e-05f, 0.00443307729f});
  // The tangent as t + t_low, and -1 / (t + t_low) by one step of Newton's.
  const F t = r + above;
  const F t_low = fma(angle.low, fma(t, t, F(1.0f)), above - (t - r));
  const F q = -1.0f / t;
  const F turned = fma(q, fma(q, t_low, fma(q, t, F(1.0f))), q);
  const BoolOf<F> odd = (angle.whole & I(1)) == I(1);
  return select(x == 0.0f, x, select(odd, turned, t + t_low));
}

// asin(s) - s for 0 <= s <= 1/2, z = s^2.
template <class F>
F asin_tail(const F& s, const F& z) {
  return (s * z) *
         polynomial(z, {0.166667521f, 0.0749531016f, 0.0454690196f, 0.0241855029f, 0.042157013f});
}

// a with the sign of x.
template <class F>
F with_sign(const F& a, const F& x) {
  return from_bits(bits(a) ^ (bits(x) & IntOf<F>(word(0x80000000u))));
}

// The angle in [-pi/2, pi/2] whose sine is x. Error below 1.8 ulp; keeps -0; NaN where |x| > 1 and
// for NaN.
template <class F>
F asin(const F& x) {
  // Beyond 1/2 by way of asin x = pi/2 - 2 asin sqrt((1 - x)/2).
  const F a = abs(x);
  const BoolOf<F> far = a > 0.5f;
  const F z = select(far, fma(a, F(-0.5f), F(0.5f)), a * a);
  const F s = select(far, sqrt(z), a);
  const F tail = asin_tail(s, z);
  const F far_angle = fma(s + (tail - 0.5f * half_pi_rest), F(-2.0f), F(half_pi));
  return with_sign(select(far, far_angle, s + tail), x);
}

// The angle in [0, pi] whose cosine is x. Error below 1.3 ulp; 0 at 1; NaN where |x| > 1 and for
// NaN.
template <class F>
F acos(const F& x) {
  const F a = abs(x);
  const BoolOf<F> far = a > 0.5f;
  const F z = select(far, fma(a, F(-0.5f), F(0.5f)), a * a);
  const F s = select(far, sqrt(z), x);
  const F tail = asin_tail(s, z);
  // pi/2 - asin x, 2 asin s, or pi - 2 asin s.
  const BoolOf<F> left = x < 0.0f;
  const F from_right = 2.0f * (s + tail);
  const F from_left = fma(s + (tail - half_pi_rest), F(-2.0f), F(pi));
  const F near_angle = half_pi - (s + (tail - half_pi_rest));
  return select(far, select(left, from_left, from_right), near_angle);
}

// atan(t) for 0 <= t <= 1.
template <class F>
F atan_reduced(const F& t) {
  const F s = t * t;
  return fma(
      s * t,
      polynomial(s, {-0.333332986f, 0.199985355f, -0.142641261f, 0.109516546f, -0.0840205625f,
                     0.0579358004f, -0.0311577655f, 0.0109045366f, -0.001791502f}),
      t);
}

// The angle in [-pi/2, pi/2] whose tangent is x. Error below 1.5 ulp; keeps -0; NaN for NaN.
template <class F>
F atan(const F& x) {
  const F a = abs(x);
  const BoolOf<F> steep = a > 1.0f;
  const F p = atan_reduced(select(steep, 1.0f / a, a));
  return with_sign(select(steep, half_pi - (p - half_pi_rest), p), x);
}

// The angle of the point (x, y) in [-pi, pi], counted from the x axis to the y axis; IEEE rules for
// zeros, signs and infinities. Error below 1.7 ulp; NaN where either is NaN.
template <class F>
F atan2(const F& y, const F& x) {
  const F ax = abs(x), ay = abs(y);
  const F shorter = min(ax, ay), longer = max(ax, ay);
  const F ratio =
      select(longer == 0.0f, F(0.0f), select(shorter == infinity, F(1.0f), shorter / longer));
  const F p = atan_reduced(ratio);
  const F first_quadrant = select(ay > ax, half_pi - (p - half_pi_rest), p);
  const BoolOf<F> left = bits(x) < IntOf<F>(0);
  const F angle = select(left, pi - (first_quadrant - pi_rest), first_quadrant);
  return select(either(x != x, y != y), F(not_a_number), with_sign(angle, y));
}

}  // namespace pse::num
