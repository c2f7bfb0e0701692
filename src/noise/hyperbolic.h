// Hyperbolic functions. Errors as in exp_log.h.
#pragma once

#include "noise/exp_log.h"

namespace pse::num {

// e^x / 2, finite wherever it is below the largest float.
template <class F>
F half_exp(const F& x) {
  Nearest<F> n;
  const F r = exp_reduce(cut(x, -104.0f, 90.0f), n);
  const F q = polynomial(r, {0.5f, 0.166665331f, 0.0416672193f, 0.00836757943f, 0.00138656329f});
  n.plus_254 = n.plus_254 - IntOf<F>(1);
  return scale_by_power(1.0f + fma(r * r, q, r), n);
}

// Error below 1.7 ulp; keeps -0; NaN for NaN.
template <class F>
F sinh(const F& x) {
  const F a = abs(x);
  const F s = a * a;
  const F near_value = fma(
      s * a, polynomial(s, {0.166666672f, 0.00833331514f, 0.000198416659f, 2.78998391e-06f}), a);
  const F e = half_exp(a);
  const F value = select(a < 1.0f, near_value, e - 0.25f / e);
  return select(x < 0.0f, -value, select(x == 0.0f, x, value));
}

// Error below 1.6 ulp; NaN for NaN.
template <class F>
F cosh(const F& x) {
  const F e = half_exp(abs(x));
  return e + 0.25f / e;
}

// Error below 1.5 ulp; keeps -0; NaN for NaN.
template <class F>
F tanh(const F& x) {
  const F a = abs(x);
  const F s = a * a;
  const F near_value = fma(
      s * a,
      polynomial(s, {-0.333332986f, 0.133319363f, -0.0537847169f, 0.0207986254f, -0.00589796668f}),
      a);
  const F e = exp(2.0f * a);
  const F far_value = 1.0f - 2.0f / (e + 1.0f);
  const F value = select(a < 0.6f, near_value, far_value);
  return select(x < 0.0f, -value, select(x == 0.0f, x, value));
}

}  // namespace pse::num
