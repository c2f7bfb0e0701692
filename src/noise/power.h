// Powers and roots, and the remainder. Errors as in exp_log.h.
#pragma once

#include "noise/exp_log.h"
#include "noise/number.h"
#include "noise/tables.h"

namespace pse::num {

// log2(x) = high + low to about 32 bits of the result, for positive finite x.
template <class F>
void log2_in_two(const F& x, F& high, F& low) {
  using I = IntOf<F>;
  // Subnormal numbers are first made normal.
  const BoolOf<F> tiny = x < 1.17549435e-38f;
  const I all = bits(select(tiny, x * 8388608.0f, x));
  // x = 2^e m, and m c = 1 + f exactly with |f| <= 1/16, c by eighths of an octave.
  const I above = all - I(0x3f355556);
  const I exponent = sar(above, I(23)), eighth = above >> I(20);
  const F m = from_bits(all - (exponent << I(23)));
  const F f = fma(m, lookup(octave_factor, eighth), F(-1.0f));
  // e - log2(c) is exact but for a rest.
  const F e = to_float(exponent - select(tiny, I(23), I(0)));
  const F whole = e + lookup(octave_log2, eighth);
  // log2(1 + f) = f / ln 2 + f^2 (q0 + f q).
  const F linear = f * log2_of_e;
  const F linear_rest = fma(f, F(log2_of_e_rest), fma(f, F(log2_of_e), -linear));
  const F q = polynomial(f, {-0.7213475108146667f, 0.48089736700057983f, -0.3606823980808258f,
                             0.2895464301109314f, -0.23942330479621887f});
  const F rest = fma(f * f, q, linear_rest) + lookup(octave_log2_rest, eighth);
  const F sum = whole + linear;
  const F sum_rest = (linear - (sum - whole)) + rest;
  high = sum + sum_rest;
  low = sum_rest - (high - sum);
}

// x^y by the rules of IEEE pow, among them: x^0 = 1^y = 1 even for NaN; NaN where x < 0 and y is
// not whole. x^1 = x and whole powers of two are exact. Error below 1 ulp and 1/18 more for
// each octave that the result is away from 1: 8 at the ends of the range.
template <class F>
F pow(const F& x, const F& y) {
  using I = IntOf<F>;
  const F a = abs(x);
  F high, low;
  log2_in_two(a, high, low);

  // 2^(y log2 a), the exponent in two parts. A larger y says no more, but could overflow.
  const F power = cut(y, -0x1p33f, 0x1p33f);
  const F product = power * high;
  const F kept = cut(product, -180.0f, 180.0f);
  const F rest = select(kept == product, fma(power, high, -product) + power * low, F(0.0f));
  const Nearest<F> n = nearest(kept);
  const F computed = scale_by_power(exp2_reduced<F>((kept - n.number) + rest), n);

  // Of 0 and infinity it is one of them; of NaN it is NaN.
  const BoolOf<F> grows = y > 0.0f, finite = a < infinity;
  const F of_infinity = select(a == a, select(grows, F(infinity), F(0.0f)), F(not_a_number));
  const F magnitude =
      select(finite, select(a == 0.0f, select(grows, F(0.0f), F(infinity)), computed), of_infinity);

  // The sign of a negative base: odd powers keep it, other whole powers lose it, and there are no
  // others.
  const F half = 0.5f * y;
  const BoolOf<F> whole = trunc(y) == y, odd = both(whole, trunc(half) != half);
  const I sign = select(odd, bits(x) & I(word(0x80000000u)), I(0));
  const F with_sign = from_bits(bits(magnitude) ^ sign);
  const BoolOf<F> undefined = both(both(x < 0.0f, finite), negate(whole));
  const F defined = select(either(undefined, y != y), F(not_a_number), with_sign);
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
