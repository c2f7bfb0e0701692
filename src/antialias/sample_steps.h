// Samples of many pixels summed up at once (steps.h), for the instructions that the including file
// is compiled for. As in neighbours.h nothing here may be kept out of line but what is local.
#pragma once

#include "antialias/lanes.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

constexpr std::size_t eight = 8;
using Eight = LanesOf<eight>::Floats;

[[gnu::always_inline]] inline Eight evens(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
}
[[gnu::always_inline]] inline Eight odds(Eight a, Eight b) {
  return __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
}

// `both` of all numbers of each of eight vectors: neighbours, then neighbours of these, and so on.
template <class Both>
[[gnu::always_inline]] inline Eight fold(const Eight* of, const Both& both) {
  Eight half[4], quarter[2];
  for (int k = 0; k < 4; ++k)
    half[k] = both(evens(of[2 * k], of[2 * k + 1]), odds(of[2 * k], of[2 * k + 1]));
  for (int k = 0; k < 2; ++k)
    quarter[k] = both(evens(half[2 * k], half[2 * k + 1]), odds(half[2 * k], half[2 * k + 1]));
  return both(evens(quarter[0], quarter[1]), odds(quarter[0], quarter[1]));
}

// As differ() of tile.h.
template <class V>
[[gnu::always_inline]] inline AnswersOf<V> differs(V a, V b) {
  constexpr float infinite = __builtin_inff();
  const V apart = size(a - b);
  const AnswersOf<V> is_same = (a == b) | ((a != a) & (b != b));
  const V least = differ_least + differ_relative * larger(size(a), size(b));
  return ~(apart <= differ_least) & ~is_same & (~(apart <= least) | (apart == infinite));
}

template <std::size_t lanes>
void judge(Ranges seen, Ranges known, const std::int32_t* asks, Ranges spread, float parts,
           std::size_t count, Verdict verdict) {
  using V = typename LanesOf<lanes>::Floats;
  using Answers = AnswersOf<V>;
  for (std::size_t i = 0; i < count; i += lanes) {
    const V low = load<V>(seen.lows + i), high = load<V>(seen.highs + i);
    const V from = load<V>(known.lows + i), to = load<V>(known.highs + i);
    const Answers exceeds = ((low < from) & differs(low, from)) | ((high > to) & differs(high, to));
    const V least = load<V>(spread.lows + i), most = load<V>(spread.highs + i);
    const Answers is_uneven = differs(least, V(least + (most - least) / parts));
    store(verdict.more + i, load<Answers>(verdict.more + i) | (exceeds & load<Answers>(asks + i)));
    store(verdict.uneven + i, load<Answers>(verdict.uneven + i) | is_uneven);
  }
}

inline void place(double x, double y, const float* offset_x, const float* offset_y,
                  std::size_t each, double* to_x, double* to_y) {
  using Doubles [[gnu::vector_size(8 * eight)]] = double;
  std::size_t k = 0;
  for (; k + eight <= each; k += eight) {
    store(to_x + k, Doubles(x + __builtin_convertvector(load<Eight>(offset_x + k), Doubles)));
    store(to_y + k, Doubles(y + __builtin_convertvector(load<Eight>(offset_y + k), Doubles)));
  }
  for (; k < each; ++k) to_x[k] = x + double(offset_x[k]), to_y[k] = y + double(offset_y[k]);
}

// Sums are taken in an order that depends on `each` alone: of every eighth value, then of these.
inline void summarise(const float* values, std::size_t count, std::size_t each,
                      const Summary& summary) {
  const auto add = [](auto a, auto b) { return a + b; };
  const auto least = [](auto a, auto b) { return smaller(a, b); };
  const auto most = [](auto a, auto b) { return larger(a, b); };
  const std::size_t whole = each / eight * eight;
  for (std::size_t k = 0; k < count; k += eight) {
    const std::size_t now = count - k < eight ? count - k : eight;
    Eight sums[eight], lows[eight], highs[eight];
    for (std::size_t l = 0; l < now; ++l) {
      const float* of = values + (k + l) * each;
      lows[l] = highs[l] = Eight{} + of[0];
      sums[l] = Eight{};
      for (std::size_t i = 0; i < whole; i += eight) {
        const Eight some = load<Eight>(of + i);
        sums[l] += some, lows[l] = smaller(some, lows[l]), highs[l] = larger(some, highs[l]);
      }
    }
    for (std::size_t l = now; l < eight; ++l) sums[l] = lows[l] = highs[l] = Eight{};
    Eight sum = fold(sums, add), low = fold(lows, least), high = fold(highs, most);
    for (std::size_t l = 0; l < now; ++l)
      for (std::size_t i = whole; i < each; ++i) {
        const float some = values[(k + l) * each + i];
        sum[l] += some, low[l] = smaller(some, low[l]), high[l] = larger(some, high[l]);
      }
    store(summary.sums + k, sum), store(summary.lows + k, low), store(summary.highs + k, high);
  }
}

}  // namespace
}  // namespace pse::antialias
