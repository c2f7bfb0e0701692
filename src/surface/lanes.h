// Doubles side by side: what is done for four rays at once. Each lane computes what a single number
// would, so a ray's answer does not depend on who is in the company (antialias/lanes.h: the same
// for floats). Everything here is part of its callers, which are compiled for more than one kind of
// processor.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pse::surface {

inline constexpr std::size_t lane_count = 4;
using Lanes [[gnu::vector_size(8 * lane_count)]] = double;
// Of comparing two Lanes: 0 (no) or -1 (yes) for each; of comparing two numbers: bool.
template <class V>
using AnswersOf = decltype(V{} < V{});
using Answers = AnswersOf<Lanes>;

// The same of a number and of many.
[[gnu::always_inline]] inline bool any(bool answer) { return answer; }
[[gnu::always_inline]] inline bool any(Answers answers) {
#ifdef __AVX__
  return __builtin_ia32_movmskpd256(__builtin_bit_cast(Lanes, answers)) != 0;
#else
  answers |= __builtin_shufflevector(answers, answers, 2, 3, 0, 1);
  return (answers[0] | answers[1]) != 0;
#endif
}
[[gnu::always_inline]] inline double choose(bool which, double yes, double no) {
  return which ? yes : no;
}
[[gnu::always_inline]] inline Lanes choose(Answers which, Lanes yes, Lanes no) {
  return which ? yes : no;
}
template <class V>
[[gnu::always_inline]] inline V larger(V a, V b) {
  return choose(a < b, b, a);
}
template <class V>
[[gnu::always_inline]] inline V smaller(V a, V b) {
  return choose(b < a, b, a);
}
template <class V>
[[gnu::always_inline]] inline V size(V value) {
  return choose(value < 0, -value, value);
}
[[gnu::always_inline]] inline double square_root(double value) { return std::sqrt(value); }
[[gnu::always_inline]] inline Lanes square_root(Lanes values) {
#ifdef __AVX__
  return __builtin_ia32_sqrtpd256(values);
#else
  return Lanes{std::sqrt(values[0]), std::sqrt(values[1]), std::sqrt(values[2]),
               std::sqrt(values[3])};
#endif
}

}  // namespace pse::surface
