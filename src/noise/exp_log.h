// Exponentials and logarithms. Few operations, no tables; polynomials found by minimax search over
// the reduced range. Errors are the greatest found over dense, random and edge arguments
// (tests/noise/math_test.cpp); an ulp is the spacing of floats at the exact result.
#pragma once

#include "noise/number.h"

namespace pse::num {

inline constexpr float log2_of_e = 1.44269502f, log2_of_e_rest = 1.92596303e-8f;
inline constexpr float ln_of_2 = 0.693147182f, ln_of_2_rest = -1.90465421e-9f;
inline constexpr float log10_of_2 = 0.30103001f, log10_of_2_rest = -1.43209888e-8f;
inline constexpr float log10_of_e = 0.434294492f, log10_of_e_rest = -1.010305e-8f;

// a with its NaN kept, cut to [low, high].
template <class F>
F cut(const F& a, float low, float high) {
  return min(F(high), max(F(low), a));
}

// 2^n for a whole n in [-126, 127].
template <class I>
auto power_of_two(const I& n) {
  return from_bits((n + I(127)) << I(23));
}

// The whole number nearest to a number in [-252, 254], halves to even: as a float, and plus 254 in
// the low bits of an integer.
template <class F>
struct Nearest {
  F number;
  IntOf<F> plus_254;
};
template <class F>
Nearest<F> nearest(const F& x) {
  // Floats from 2^23 on are whole; 2^22 more keeps the sum of a negative x among them.
  constexpr float shift = 0x1.8p23f + 254;
  const F sum = x + shift;
  return {sum - shift, bits(sum)};
}

// a 2^n with one rounding, for a near 1.
template <class F>
F scale_by_power(const F& a, const Nearest<F>& n) {
  using I = IntOf<F>;
  // n + 254 as the sum of two exponents with their bias.
  const I half = n.plus_254 >> I(1);
  return a * from_bits(half << I(23)) * from_bits((n.plus_254 - half) << I(23));
}

// x = n ln 2 + r with |r| <= ln 2 / 2.
template <class F>
F exp_reduce(const F& x, Nearest<F>& n) {
  n = nearest(x * log2_of_e);
  return fma(n.number, F(-ln_of_2_rest), fma(n.number, F(-ln_of_2), x));
}

// e^x. Error below 1.1 ulp; NaN for NaN.
template <class F>
F exp(const F& x) {
  Nearest<F> n;
  const F r = exp_reduce(cut(x, -104.0f, 89.0f), n);
  const F q = polynomial(r, {0.5f, 0.166665331f, 0.0416672193f, 0.00836757943f, 0.00138656329f});
  return scale_by_power(1.0f + fma(r * r, q, r), n);
}

// 2^r for |r| <= 1/2.
template <class F>
F exp2_reduced(const F& r) {
  const F q = polynomial(r, {0.693147182f, 0.240226507f, 0.0555035807f, 0.00961808022f,
                             0.00133916701f, 0.000154546928f});
  return fma(r, q, F(1.0f));
}

// 2^x. Error below 1 ulp; exact for whole x; NaN for NaN.
template <class F>
F exp2(const F& x) {
  const F kept = cut(x, -151.0f, 129.0f);
  const Nearest<F> n = nearest(kept);
  return scale_by_power(exp2_reduced<F>(kept - n.number), n);
}

// e^x - 1, precise near 0. Error below 1.5 ulp; keeps -0; NaN for NaN.
template <class F>
F expm1(const F& x) {
  Nearest<F> n;
  const F r = exp_reduce(cut(x, -30.0f, 89.0f), n);
  const F q = polynomial(
      r, {0.5f, 0.166666672f, 0.0416664816f, 0.00833321176f, 0.00139333541f, 0.000199404138f});
  const F e = fma(r * r, q, r);
  // 2^n (1 + e) - 1 by way of 2^(n-1), which is in range for every n.
  const F s = power_of_two(n.plus_254 - 255);
  return select(x == 0.0f, x, 2.0f * fma(s, e, s - 0.5f));
}

// A positive finite x as 2^e (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)).
template <class F>
struct Split {
  F e, f;
};
template <class F>
Split<F> split(const F& x) {
  using I = IntOf<F>;
  // Subnormal numbers are first made normal.
  const BoolOf<F> tiny = x < 1.17549435e-38f;
  const I all = bits(select(tiny, x * 8388608.0f, x));
  const I exponent = sar(all - I(0x3f3504f3), I(23));
  const F m = from_bits(all - (exponent << I(23)));
  return {to_float(exponent - select(tiny, I(23), I(0))), m - 1.0f};
}

// log(1 + f) - f for 1 + f in [sqrt(1/2), sqrt(2)).
template <class F>
F log_tail(const F& f) {
  const F q = polynomial(f, {-0.5f, 0.333333433f, -0.250008285f, 0.200006127f, -0.166226909f,
                             0.142117321f, -0.131749466f, 0.127104208f, -0.0754154325f});
  return (f * f) * q;
}

// The value of a logarithm that was computed as if 0 < x < infinity: the limits, and NaN below 0
// and for NaN.
template <class F>
F log_limits(const F& x, const F& computed) {
  const F below = select(x == 0.0f, F(-infinity), F(not_a_number));
  return select(x > 0.0f, select(x == infinity, x, computed), below);
}

// The natural logarithm. Error below 1 ulp; -infinity at 0; NaN below 0 and for NaN.
template <class F>
F log(const F& x) {
  const Split<F> s = split(x);
  const F rest = fma(s.e, F(ln_of_2_rest), log_tail(s.f));
  return log_limits(x, fma(s.e, F(ln_of_2), s.f + rest));
}

// The logarithm to base 2. Error below 1.2 ulp; exact for powers of 2; -infinity at 0; NaN below 0
// and for NaN.
template <class F>
F log2(const F& x) {
  const Split<F> s = split(x);
  const F rest = fma(s.f, F(log2_of_e_rest), log_tail(s.f) * log2_of_e);
  return log_limits(x, s.e + fma(s.f, F(log2_of_e), rest));
}

// The logarithm to base 10. Error below 1.2 ulp; -infinity at 0; NaN below 0 and for NaN.
template <class F>
F log10(const F& x) {
  const Split<F> s = split(x);
  const F rest =
      fma(s.e, F(log10_of_2_rest), fma(s.f, F(log10_of_e_rest), log_tail(s.f) * log10_of_e));
  return log_limits(x, fma(s.e, F(log10_of_2), fma(s.f, F(log10_of_e), rest)));
}

// log(1 + x), precise near 0. Error below 1.5 ulp; keeps -0; -infinity at -1; NaN below -1 and for
// NaN.
template <class F>
F log1p(const F& x) {
  using I = IntOf<F>;
  const F u = 1.0f + x;
  const Split<F> s = split(u);
  // What 1 + x lost to rounding comes back into f; from 2^25 on nothing of the 1 is left.
  const F scale = from_bits(I(0x3f800000) - (to_int(min(s.e, F(25.0f))) << I(23)));
  const F f = select(s.e > 25.0f, s.f, fma(x, scale, scale - 1.0f));
  const F rest = fma(s.e, F(ln_of_2_rest), log_tail(f));
  const F result = log_limits(u, fma(s.e, F(ln_of_2), f + rest));
  return select(x == 0.0f, x, result);
}

}  // namespace pse::num
