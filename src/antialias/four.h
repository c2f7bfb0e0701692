// Four numbers side by side: the vectors of what is done for many pixels or samples at once. Each
// lane computes what a single number would, so results do not depend on who is in the company.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pse::antialias {

using Four = float __attribute__((vector_size(16)));
// One for each number: 0 (no) or -1 (yes).
using Answers = std::int32_t __attribute__((vector_size(16)));
inline constexpr std::size_t four = 4;

inline Four load(const float* from) {
  Four values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
// The first `count` of four; the others are 0.
inline Four load(const float* from, std::size_t count) {
  if (count >= four) return load(from);
  Four values{};
  for (std::size_t i = 0; i < count; ++i) values[i] = from[i];
  return values;
}
inline void store(float* to, Four values) { std::memcpy(to, &values, sizeof values); }

// The same of a number and of four.
inline float size(float value) { return std::abs(value); }
inline Four size(Four values) {
  const Answers bits = std::bit_cast<Answers>(values) & 0x7fffffff;
  return std::bit_cast<Four>(bits);
}
inline float larger(float a, float b) { return a > b ? a : b; }
inline Four larger(Four a, Four b) { return a > b ? a : b; }
inline float smaller(float a, float b) { return a < b ? a : b; }
inline Four smaller(Four a, Four b) { return a < b ? a : b; }
// `low` to `high`; NaN stays.
inline float clamped(float value, float low, float high) {
  return value < low ? low : high < value ? high : value;
}
inline Four clamped(Four value, float low, float high) {
  const Four above = value < low ? Four{} + low : value;
  return high < above ? Four{} + high : above;
}
inline Four choose(Answers which, Four yes, Four no) { return which ? yes : no; }

inline bool any(Answers answers) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(answers);
  return (halves[0] | halves[1]) != 0;
}

}  // namespace pse::antialias
