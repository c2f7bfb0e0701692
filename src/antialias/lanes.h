// Numbers side by side: the vectors of what is done for many pixels or samples at once. Each lane
// computes what a single number would, so results do not depend on who is in the company.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pse::antialias {

// `count` numbers; comparing two such gives an answer for each: 0 (no) or -1 (yes).
template <std::size_t count>
struct LanesOf {
  using Floats [[gnu::vector_size(4 * count)]] = float;
  using Halves [[gnu::vector_size(4 * count)]] = std::int64_t;  // their bits, two and two
};
template <class V>
using AnswersOf = decltype(V{} < V{});
template <class V>
inline constexpr std::size_t lanes_of = sizeof(V) / sizeof(float);

inline constexpr std::size_t four = 4;
using Four = LanesOf<four>::Floats;

// All are part of their callers, which may be compiled for more than one kind of processor.
template <class V>
[[gnu::always_inline]] inline V load(const void* from) {
  V values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
template <class V>
[[gnu::always_inline]] inline void store(void* to, V values) {
  std::memcpy(to, &values, sizeof values);
}

template <class V>
[[gnu::always_inline]] inline AnswersOf<V> bits(V values) {
  return __builtin_bit_cast(AnswersOf<V>, values);
}

// Of whole numbers.
template <class V>
[[gnu::always_inline]] inline AnswersOf<V> whole(V values) {
  return __builtin_convertvector(values, AnswersOf<V>);
}

// The same of a number and of many.
[[gnu::always_inline]] inline float size(float value) { return std::abs(value); }
template <class V>
[[gnu::always_inline]] inline V size(V values) {
  return __builtin_bit_cast(V, bits(values) & 0x7fffffff);
}
template <class V>
[[gnu::always_inline]] inline V larger(V a, V b) {
  return a > b ? a : b;
}
template <class V>
[[gnu::always_inline]] inline V smaller(V a, V b) {
  return a < b ? a : b;
}
// `low` to `high`; NaN stays.
template <class V>
[[gnu::always_inline]] inline V clamped(V value, float low, float high) {
  const V above = value < low ? V{} + low : value;
  return high < above ? V{} + high : above;
}
template <class V>
[[gnu::always_inline]] inline V choose(AnswersOf<V> which, V yes, V no) {
  return which ? yes : no;
}

// All lanes' bits together.
template <class A>
[[gnu::always_inline]] inline std::int64_t together(A lanes) {
  using Halves = typename LanesOf<lanes_of<A>>::Halves;
  Halves all = __builtin_bit_cast(Halves, lanes);
  // Halves onto halves, until there are two.
  if constexpr (sizeof(A) == 8 * sizeof(std::int64_t))
    all |= __builtin_shufflevector(all, all, 4, 5, 6, 7, 0, 1, 2, 3);
  if constexpr (sizeof(A) == 8 * sizeof(std::int64_t))
    all |= __builtin_shufflevector(all, all, 2, 3, 0, 1, 6, 7, 4, 5);
  else if constexpr (sizeof(A) == 4 * sizeof(std::int64_t))
    all |= __builtin_shufflevector(all, all, 2, 3, 0, 1);
  return all[0] | all[1];
}
// Whether there is a yes.
template <class A>
[[gnu::always_inline]] inline bool any(A answers) {
  return together(answers) != 0;
}
// Bit k is answer k.
template <class A>
[[gnu::always_inline]] inline std::uint32_t mask_of(A answers) {
  A bit{};
  for (std::size_t k = 0; k < lanes_of<A>; ++k) bit[k] = 1 << k;
  const std::int64_t all = together(answers & bit);
  return static_cast<std::uint32_t>(all | all >> 32);
}

}  // namespace pse::antialias
