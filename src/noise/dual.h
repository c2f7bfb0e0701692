// Numbers with derivatives: a value and its N partial derivatives, for Dnoise and filter widths. A
// derivative known to be zero is absent rather than stored, so no operation is spent on it and no 0
// * infinity can arise.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "noise/number.h"

namespace pse::num {

// A partial derivative; nothing where it is zero by construction.
template <class F>
using Slope = std::optional<F>;

template <class F>
Slope<F> operator+(const Slope<F>& a, const Slope<F>& b) {
  if (!a) return b;
  if (!b) return a;
  return *a + *b;
}
template <class F>
Slope<F> minus(const Slope<F>& a, const Slope<F>& b) {
  if (!b) return a;
  if (!a) return -*b;
  return *a - *b;
}
template <class F>
Slope<F> scale(const F& factor, const Slope<F>& a) {
  if (!a) return std::nullopt;
  return factor * *a;
}
// factor * a + b
template <class F>
Slope<F> scale_add(const F& factor, const Slope<F>& a, const Slope<F>& b) {
  if (!a) return b;
  if (!b) return factor * *a;
  return fma(factor, *a, *b);
}

template <class F, std::size_t N>
struct Dual {
  F value;
  std::array<Slope<F>, N> slope;

  Dual() = default;
  Dual(float constant) : value(constant) {}
  Dual(const F& constant) requires(!std::is_same_v<F, float>) : value(constant) {}
  Dual(const F& v, const std::array<Slope<F>, N>& s) : value(v), slope(s) {}
  // The axis'th of the variables to derive by.
  static Dual variable(const F& v, std::size_t axis) {
    Dual result(v);
    result.slope[axis] = F(1.0f);
    return result;
  }

  // A function of this number: its value, and its derivative that multiplies ours.
  Dual chain(const F& result, const F& derivative) const {
    Dual out(result);
    for (std::size_t i = 0; i < N; ++i) out.slope[i] = scale(derivative, slope[i]);
    return out;
  }

  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual out(a.value + b.value);
    for (std::size_t i = 0; i < N; ++i) out.slope[i] = num::operator+(a.slope[i], b.slope[i]);
    return out;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual out(a.value - b.value);
    for (std::size_t i = 0; i < N; ++i) out.slope[i] = minus(a.slope[i], b.slope[i]);
    return out;
  }
  friend Dual operator-(const Dual& a) {
    Dual out(-a.value);
    for (std::size_t i = 0; i < N; ++i) {
      if (a.slope[i]) out.slope[i] = -*a.slope[i];
    }
    return out;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual out(a.value * b.value);
    for (std::size_t i = 0; i < N; ++i) {
      out.slope[i] = scale_add(b.value, a.slope[i], scale(a.value, b.slope[i]));
    }
    return out;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual out(a.value / b.value);
    for (std::size_t i = 0; i < N; ++i) {
      const Slope<F> top = scale_add(-out.value, b.slope[i], a.slope[i]);
      if (top) out.slope[i] = *top / b.value;
    }
    return out;
  }
  friend Dual fma(const Dual& a, const Dual& b, const Dual& c) {
    Dual out(fma(a.value, b.value, c.value));
    for (std::size_t i = 0; i < N; ++i) {
      out.slope[i] = scale_add(a.value, b.slope[i], scale_add(b.value, a.slope[i], c.slope[i]));
    }
    return out;
  }
  friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  friend auto operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend auto operator!=(const Dual& a, const Dual& b) { return a.value != b.value; }

  // Steps are flat between their jumps.
  friend Dual floor(const Dual& a) { return Dual(floor(a.value)); }
  friend Dual trunc(const Dual& a) { return Dual(trunc(a.value)); }
  friend Dual round(const Dual& a) { return Dual(round(a.value)); }
  friend auto to_int(const Dual& a) { return to_int(a.value); }
  friend Dual sqrt(const Dual& a) {
    const F root = sqrt(a.value);
    return a.chain(root, 0.5f / root);
  }
};

template <class F, std::size_t N>
struct Kinds<Dual<F, N>> {
  using Integer = IntOf<F>;
  using Truth = BoolOf<F>;
  using Base = F;
};

// The variables of an N-dimensional function at a point.
template <class F, std::size_t N>
std::array<Dual<F, N>, N> variables(const std::array<F, N>& point) {
  std::array<Dual<F, N>, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = Dual<F, N>::variable(point[i], i);
  return result;
}

// The gradient of a result: zero where a derivative is absent.
template <class F, std::size_t N>
std::array<F, N> gradient(const Dual<F, N>& result) {
  std::array<F, N> out;
  for (std::size_t i = 0; i < N; ++i) out[i] = result.slope[i].value_or(F(0.0f));
  return out;
}

}  // namespace pse::num
