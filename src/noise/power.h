// Powers and roots, and the remainder. Errors as in exp_log.h.
#pragma once

#include "noise/exp_log.h"
#include "noise/number.h"

namespace pse::num {

// a + b = high + low exactly, for |a| >= |b| or a = 0.
template <class F>
void fast_two_sum(const F& a, const F& b, F& high, F& low) {
  high = a + b;
  low = b - (high - a);
}

// log2(x) = high + low to about 35 bits, for positive finite x.
template <class F>
void log2_in_two(const F& x, F& high, F& low) {
  const Split<F> s = split(x);
  // t = f / (2 + f) in two parts; log(1 + f) = 2 (t + t^3 / 3 + t^5 / 5 + ...).
  const F d = 2.0f + s.f;
  const F d_rest = s.f - (d - 2.0f);
  const F reciprocal = 1.0f / d;
  const F t = s.f * reciprocal;
  const F t_rest = reciprocal * fma(-t, d_rest, fma(-t, d, s.f));
  // The cubic term in two parts as well: t^2 (c + ...) times t.
  constexpr float c = 0.961796701f, c_rest = -7.02846181e-9f;
  const F t2 = t * t;
  const F t2_rest = fma(t, t, -t2);
  const F cubic = t2 * c;
  const F cubic_rest = fma(t2, F(c), -cubic) + fma(t2_rest, F(c), t2 * c_rest);
  const F higher =
      fma(t2 * t2, polynomial(t2, {0.57708025f, 0.411844313f, 0.337947696f}), cubic_rest);
  const F term = t * cubic;
  const F term_rest = fma(t, cubic, -term) + t * higher;
  // 2 / ln 2 times t, and the exponent.
  constexpr float k = 2.88539004f, k_rest = 3.85192607e-8f;
  const F linear = t * k;
  const F linear_rest = fma(t, F(k), -linear) + fma(t, F(k_rest), t_rest * fma(t2, F(k), F(k)));
  F mantissa, mantissa_rest, sum, sum_rest;
  fast_two_sum(linear, term, mantissa, mantissa_rest);
  fast_two_sum(s.e, mantissa, sum, sum_rest);
  fast_two_sum(sum, sum_rest + (mantissa_rest + (linear_rest + term_rest)), high, low);
}

// x^y by the rules of IEEE pow, among them: x^0 = 1^y = 1 even for NaN; NaN where x < 0 and y is
// not whole. x^1 = x and whole powers of two are exact. Error below 1 ulp.
template <class F>
F pow(const F& x, const F& y) {
  using I = IntOf<F>;
  const F a = abs(x);
  F high, low;
  log2_in_two(a, high, low);

  // 2^(y log2 a), the exponent in two parts.
  const F product = y * high;
  const F kept = cut(product, -180.0f, 180.0f);
  const F rest = select(kept == product, fma(y, high, -product) + y * low, F(0.0f));
  const F n = round(kept);
  const F r = (kept - n) + rest;
  const F q = polynomial(r, {0.693147182f, 0.240226507f, 0.0555035807f, 0.00961808022f,
                             0.00133916701f, 0.000154546928f});
  const F computed = scale_by_power(fma(r, q, F(1.0f)), n);

  // Where a is 0, 1 or infinite, or y is infinite, the magnitude is 0, 1 or infinity.
  const BoolOf<F> grows = either(both(a > 1.0f, y > 0.0f), both(a < 1.0f, y < 0.0f));
  const F limit = select(a == 1.0f, F(1.0f), select(grows, F(infinity), F(0.0f)));
  const BoolOf<F> at_limit =
      either(either(a == 0.0f, a == infinity), either(a == 1.0f, abs(y) == infinity));
  const F magnitude = select(at_limit, limit, computed);

  // The sign of a negative base: odd powers keep it, other whole powers lose it, and there are no
  // others.
  const BoolOf<F> whole = trunc(y) == y;
  const BoolOf<F> odd = both(both(whole, abs(y) < 16777216.0f), (to_int(y) & I(1)) == I(1));
  const BoolOf<F> negative = bits(x) < I(0);
  const F signed_magnitude = select(both(odd, negative), -magnitude, magnitude);
  const BoolOf<F> undefined =
      both(both(x < 0.0f, negate(whole)), both(abs(x) < infinity, abs(y) < infinity));
  const F defined =
      select(either(undefined, either(x != x, y != y)), F(not_a_number), signed_magnitude);
  return select(either(y == 0.0f, x == 1.0f), F(1.0f), select(y == 1.0f, x, defined));
}

// The cube root, of negative numbers too. Error below 0.8 ulp; NaN for NaN.
template <class F>
F cbrt(const F& x) {
  using I = IntOf<F>;
  const F magnitude = abs(x);
  const BoolOf<F> tiny = magnitude < 0x1p-96f;
  const F a = select(tiny, magnitude * 0x1p72f, magnitude);
  // a^(-1/3): a guess from the exponent, then two steps of third order.
  F y = from_bits(I(0x54a21d2a) - to_int(to_float(bits(a)) * 0.333333343f));
  for (int step = 0; step < 2; ++step) {
    const F c = fma(-(a * y), y * y, F(1.0f));
    y = fma(y * c, fma(c, F(0.222222224f), F(0.333333343f)), y);
  }
  // a^(1/3) = a y^2, corrected by Newton's step.
  const F y2 = y * y;
  const F root = a * y2;
  const F better = fma(fma(root * root, root, -a) * -0.333333343f, y2, root);
  const F scaled = select(tiny, better * 0x1p-24f, better);
  const F result = select(x < 0.0f, -scaled, scaled);
  return select(either(x == 0.0f, magnitude == infinity), x, result);
}

// sqrt(x^2 + y^2) without overflow on the way. Error below 1.3 ulp; infinite where either is, else
// NaN where either is.
template <class F>
F hypot(const F& x, const F& y) {
  using I = IntOf<F>;
  const F a = abs(x), b = abs(y);
  // A power of two near the larger brings both into range.
  const F larger = min(max(max(a, b), F(1.17549435e-38f)), F(8.50705917e37f));
  const I exponent = bits(larger) & I(0x7f800000);
  const F scale = from_bits(I(0x7f000000) - exponent);
  const F p = a * scale, q = b * scale;
  const F result = sqrt(fma(p, p, q * q)) * from_bits(exponent);
  return select(either(a == infinity, b == infinity), F(infinity), result);
}

// a - b floor(a / b), with the sign of b: in [0, b] for b > 0. NaN for b = 0, for infinite a or b,
// and for NaN. Exact while a / b is below 2^24.
template <class F>
F mod(const F& a, const F& b) {
  const F r = fma(-floor(a / b), b, a);
  // A quotient rounded up to a whole number leaves a remainder of the wrong sign.
  const BoolOf<F> wrong = either(both(b > 0.0f, r < 0.0f), both(b<0.0f, r> 0.0f));
  return select(wrong, r + b, r);
}

}  // namespace pse::num
