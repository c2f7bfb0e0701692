// The vocabulary that every builtin numeric function is written in, for plain C++ numbers. One
// template body per idea: instantiated with `float` it is the C++ library, with Dual (noise/dual.h)
// it carries derivatives, with IrFloat (lower/ir_value.h) it writes IR. Each word here means one
// operator of the table in ir/ops.cpp, edge cases included.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

namespace pse::num {

inline constexpr float infinity = std::numeric_limits<float>::infinity();
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// A 32-bit integer whose arithmetic is modulo 2^32. `<<` and `>>` shift zeros in; `sar` shifts the
// sign in.
struct Int {
  std::int32_t value = 0;

  constexpr Int() = default;
  constexpr Int(std::int32_t v) : value(v) {}
  static constexpr Int of(std::uint32_t v) { return {static_cast<std::int32_t>(v)}; }
  constexpr std::uint32_t bits() const { return static_cast<std::uint32_t>(value); }

  friend constexpr Int operator+(Int a, Int b) { return of(a.bits() + b.bits()); }
  friend constexpr Int operator-(Int a, Int b) { return of(a.bits() - b.bits()); }
  friend constexpr Int operator*(Int a, Int b) { return of(a.bits() * b.bits()); }
  friend constexpr Int operator&(Int a, Int b) { return of(a.bits() & b.bits()); }
  friend constexpr Int operator|(Int a, Int b) { return of(a.bits() | b.bits()); }
  friend constexpr Int operator^(Int a, Int b) { return of(a.bits() ^ b.bits()); }
  friend constexpr Int operator<<(Int a, Int b) {
    return b.bits() > 31 ? Int(0) : of(a.bits() << b.bits());
  }
  friend constexpr Int operator>>(Int a, Int b) {
    return b.bits() > 31 ? Int(0) : of(a.bits() >> b.bits());
  }
  friend constexpr Int sar(Int a, Int b) { return {a.value >> (b.bits() > 31 ? 31 : b.value)}; }
  friend constexpr bool operator==(Int a, Int b) { return a.value == b.value; }
  friend constexpr bool operator!=(Int a, Int b) { return a.value != b.value; }
  friend constexpr bool operator<(Int a, Int b) { return a.value < b.value; }
};

// A constant with all 32 bits given, for masks and multipliers above 2^31.
constexpr std::int32_t word(std::uint32_t bits) { return static_cast<std::int32_t>(bits); }

// The integer and truth types that go with a number type, and the number without its derivatives.
template <class F>
struct Kinds;
template <>
struct Kinds<float> {
  using Integer = Int;
  using Truth = bool;
  using Base = float;
};
template <class F>
using IntOf = typename Kinds<F>::Integer;
template <class F>
using BoolOf = typename Kinds<F>::Truth;
template <class F>
using BaseOf = typename Kinds<F>::Base;

// Constant tables. The number of entries is a power of two (bytes: 256); an index counts modulo
// that.
struct FloatTable {
  std::string_view name;
  std::span<const float> entries;
};
struct IntTable {
  std::string_view name;
  std::span<const std::int32_t> entries;
};
struct ByteTable {
  std::string_view name;
  std::span<const std::uint8_t, 256> entries;
};

inline float fma(float a, float b, float c) { return std::fma(a, b, c); }
inline float sqrt(float a) { return std::sqrt(a); }
inline float abs(float a) { return std::fabs(a); }
inline float floor(float a) { return std::floor(a); }
inline float ceil(float a) { return std::ceil(a); }
inline float trunc(float a) { return std::trunc(a); }
// To the nearest integer, halves to even.
inline float round(float a) { return std::nearbyint(a); }
// The second operand where either is NaN and where both are zero.
constexpr float min(float a, float b) { return a < b ? a : b; }
constexpr float max(float a, float b) { return a > b ? a : b; }

constexpr bool both(bool a, bool b) { return a && b; }
constexpr bool either(bool a, bool b) { return a || b; }
constexpr bool negate(bool a) { return !a; }
constexpr float select(bool condition, float yes, float no) { return condition ? yes : no; }
constexpr Int select(bool condition, Int yes, Int no) { return condition ? yes : no; }

// Without the fraction; -2^31 where that does not fit and for NaN.
constexpr Int to_int(float a) {
  const bool fits = a >= -2147483648.0f && a < 2147483648.0f;
  return fits ? static_cast<std::int32_t>(a) : std::numeric_limits<std::int32_t>::min();
}
constexpr float to_float(Int a) { return static_cast<float>(a.value); }
constexpr Int bits(float a) { return std::bit_cast<std::int32_t>(a); }
constexpr float from_bits(Int a) { return std::bit_cast<float>(a.value); }

inline float lookup(const FloatTable& table, Int index) {
  return table.entries[index.bits() & (table.entries.size() - 1)];
}
inline Int lookup(const IntTable& table, Int index) {
  return table.entries[index.bits() & (table.entries.size() - 1)];
}
// Each of the four bytes replaced by that entry of the table.
inline Int lookup(const ByteTable& table, Int a) {
  std::uint32_t result = 0;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    result |= static_cast<std::uint32_t>(table.entries[(a.bits() >> shift) & 255u]) << shift;
  }
  return Int::of(result);
}
// Each of the four bytes of a plus the same byte of b, modulo 256.
constexpr Int bytes_add(Int a, Int b) {
  const std::uint32_t low = (a.bits() & 0x7f7f7f7fu) + (b.bits() & 0x7f7f7f7fu);
  return Int::of(low ^ ((a.bits() ^ b.bits()) & 0x80808080u));
}

// One of two pure computations. Compiled code may skip the side that no sample takes, so a rare and
// dear case goes here rather than into a select.
template <std::size_t Count, class Then, class Else>
std::array<float, Count> choose(bool condition, const Then& then_side, const Else& else_side) {
  return condition ? then_side() : else_side();
}

// a at t = 0, b at t = 1 up to rounding.
template <class F>
F lerp(const F& t, const F& a, const F& b) {
  return fma(t, b - a, a);
}

// c[0] + c[1] x + c[2] x^2 + ... by Horner's rule.
template <class F, std::size_t Count>
F polynomial(const F& x, const float (&c)[Count]) {
  F sum = c[Count - 1];
  for (std::size_t i = Count - 1; i-- > 0;) sum = fma(sum, x, F(c[i]));
  return sum;
}

}  // namespace pse::num
