// Numbers side by side: the vectors of what is done for many pixels or samples at once. Each lane
// computes what a single number would, so results do not depend on who is in the company.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifdef __SSE2__
#include <immintrin.h>
#endif

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
template <class V>
[[gnu::always_inline]] inline V square_root(V values) {
  for (std::size_t lane = 0; lane < lanes_of<V>; ++lane)
    values[lane] = __builtin_sqrtf(values[lane]);
  return values;
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

// Bit k is answer k. Where one instruction gives them, that.
template <class A>
[[gnu::always_inline]] inline std::uint32_t mask_of(A answers) {
#ifdef __AVX512DQ__
  if constexpr (sizeof(A) == sizeof(__m512i))
    return _mm512_movepi32_mask(__builtin_bit_cast(__m512i, answers));
#endif
#ifdef __AVX__
  if constexpr (sizeof(A) == sizeof(__m256))
    return static_cast<std::uint32_t>(_mm256_movemask_ps(__builtin_bit_cast(__m256, answers)));
#endif
#ifdef __SSE2__
  if constexpr (sizeof(A) == sizeof(__m128))
    return static_cast<std::uint32_t>(_mm_movemask_ps(__builtin_bit_cast(__m128, answers)));
#endif
  std::uint32_t mask = 0;
  for (std::size_t k = 0; k < lanes_of<A>; ++k) mask |= (answers[k] & 1u) << k;
  return mask;
}
// Whether there is a yes, or a number that is not 0.
template <class A>
[[gnu::always_inline]] inline bool any(A answers) {
#ifdef __AVX__
  if constexpr (sizeof(A) >= sizeof(__m256)) return mask_of(answers != 0) != 0;
#endif
  std::int64_t all = 0;
  const auto halves = __builtin_bit_cast(typename LanesOf<lanes_of<A>>::Halves, answers);
  for (std::size_t k = 0; k < lanes_of<A> / 2; ++k) all |= halves[k];
  return all != 0;
}

}  // namespace pse::antialias
