// The means of a row's pixels from samples half a pixel apart (half_grid.h), for the instructions
// that the including file is compiled for. As in neighbours.h nothing here may be kept out of line
// but what is local.
#pragma once

#include "antialias/lanes.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

constexpr float finite = 3e38f;

template <std::size_t lanes>
void mean_of_halves(const HalfRow& at, const HalfMeans& by, std::size_t count, float* means) {
  using V = typename LanesOf<lanes>::Floats;
  using Answers = AnswersOf<V>;
  const std::ptrdiff_t row = at.row, half_row = at.half_row;
  for (std::size_t i = 0; i < count; i += lanes) {
    const float* path = at.path + i;
    const Answers way = load<Answers>(path);
    Answers has_next = Answers{} - 1;
    for (const std::ptrdiff_t step : {std::ptrdiff_t{-1}, std::ptrdiff_t{1}, -row, row})
      has_next &= load<Answers>(path + step) == way;
    const auto weight = [&](float HalfWeights::*of) {
      return choose(has_next, V{} + by.with_next.*of, V{} + by.alone.*of);
    };

    const float *middles = at.middles + i, *beside = at.beside + i, *below = at.below + i;
    const float* corner = at.corner + i;
    const V middle = load<V>(middles);
    V least = middle, most = middle;
    const auto sum = [&](V a, V b, V c, V d) {
      least = smaller(smaller(smaller(a, b), smaller(c, d)), least);
      most = larger(larger(larger(a, b), larger(c, d)), most);
      return (a + b) + (c + d);
    };
    const auto next = [&](std::ptrdiff_t step) {
      return choose(has_next, load<V>(middles + step), middle);
    };
    const V sides =
        sum(load<V>(beside), load<V>(beside + 1), load<V>(below), load<V>(below + half_row));
    const V corners = sum(load<V>(corner), load<V>(corner + 1), load<V>(corner + half_row),
                          load<V>(corner + half_row + 1));
    const V others = sum(next(-1), next(1), next(-row), next(row));
    const V mean = weight(&HalfWeights::middle) * middle + weight(&HalfWeights::side) * sides +
                   weight(&HalfWeights::corner) * corners + weight(&HalfWeights::next) * others;
    // What a single sample shows may weigh less than nothing.
    store(means + i, choose(size(mean) < finite, smaller(larger(mean, least), most), mean));
  }
}

}  // namespace
}  // namespace pse::antialias
