// Numbers that the noise functions are held to, and a second, plain implementation of the lattice
// noises in double.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "noise/number.h"
#include "noise/tables.h"

namespace pse::test {

struct NoiseValue {
  std::array<float, 3> point;
  double noise;
  std::array<double, 3> gradient;
};

// The 2002 noise in exact rational arithmetic (reference implementation's semantics), inputs as
// written in decimal.
inline const std::vector<NoiseValue> improved_values = {
    {{0.5f, 0.5f, 0.5f}, -0.25, {-0.6875, 0.25, 0.0}},
    {{0.25f, 0.5f, 0.75f},
     -0.2697153091430664,
     {-0.4184722900390625, -0.5439579486846924, -0.8597679138183594}},
    {{0.125f, 0.375f, 0.625f},
     0.07959671304035965,
     {-0.7426992667492414, -1.411528067511881, -0.9879466460915864}},
    {{1.5f, 2.5f, 3.5f}, 0.125, {0.46875, 0.65625, -0.71875}},
    {{3.14f, 42.0f, 7.0f}, 0.136919958784, {0.9171158336, -0.9559994112, -0.0220002944}},
    {{-0.5f, -0.5f, -0.5f}, -0.875, {0.46875, -0.46875, -0.21875}},
    {{-1.25f, 2.75f, -3.125f},
     0.268663933762582,
     {1.2806734362384304, -0.9299852446420118, -0.8847050676122308}},
    {{10.1f, 20.2f, 30.3f},
     -0.4249812496,
     {0.198966626756352, -0.528720195437568, -0.477800040356352}},
    {{255.5f, 255.5f, 255.5f}, -0.875, {0.46875, -0.46875, -0.21875}},
    {{255.75f, 0.25f, 128.5f},
     0.2897815704345703,
     {0.2525005340576172, -0.11293220520019531, -0.4334685802459717}},
    {{256.25f, 0.5f, 0.75f},
     -0.2697153091430664,
     {-0.4184722900390625, -0.5439579486846924, -0.8597679138183594}},
    {{-256.25f, 0.5f, 0.75f},
     -0.018218517303466797,
     {0.3864936828613281, -0.8965390920639038, -0.1735515594482422}},
};

// The chapter's listing in double, at points that its float program can tell apart.
inline const std::vector<std::pair<std::array<float, 3>, double>> book_values = {
    {{0.5f, 0.5f, 0.5f}, -0.40576462398594},
    {{0.25f, 0.5f, 0.75f}, -0.08381823790352},
    {{0.125f, 0.375f, 0.625f}, 0.005482965356751},
    {{1.5f, 2.5f, 3.5f}, 0.155561043135652},
    {{-0.5f, -0.5f, -0.5f}, 0.542307934897249},
    {{-1.25f, 2.75f, -3.125f}, -0.122610554855428},
    {{10.125f, 20.25f, 30.375f}, -0.113254905533536},
    {{255.5f, 255.5f, 255.5f}, 0.542307934897249},
    {{255.75f, 0.25f, 128.5f}, 0.086264643499513},
    {{256.25f, 0.5f, 0.75f}, -0.08381823790352},
    {{0.0f, 0.0f, 0.0f}, 0.0},
    {{17.0f, -5.0f, 200.0f}, 0.0},
};

// The chapter's "sum of wavelets" in double, straight from the definition: for every corner its
// gradient's linear function times a weight that falls along each axis. `order` lists the axes as
// the hash folds them.
template <std::size_t N>
double wavelet_sum(const std::array<float, N>& point, const std::array<std::size_t, N>& order,
                   std::span<const num::FloatTable> gradients, double (*fade)(double)) {
  double sum = 0;
  for (std::size_t c = 0; c < (std::size_t{1} << N); ++c) {
    int hash = 0;
    for (const std::size_t axis : order) {
      const double lattice =
          std::floor(static_cast<double>(point[axis])) + static_cast<double>((c >> axis) & 1);
      const auto index = static_cast<int>(lattice - 256.0 * std::floor(lattice / 256.0));
      hash = num::permutation.entries[static_cast<std::size_t>((hash + index) & 255)];
    }
    double weight = 1, linear = 0;
    for (std::size_t axis = 0; axis < N; ++axis) {
      const double way = point[axis] - std::floor(static_cast<double>(point[axis])) -
                         static_cast<double>((c >> axis) & 1);
      const auto& entries = gradients[axis].entries;
      linear +=
          static_cast<double>(entries[static_cast<std::size_t>(hash) & (entries.size() - 1)]) * way;
      weight *= 1 - fade(std::fabs(way));
    }
    sum += weight * linear;
  }
  return sum;
}

}  // namespace pse::test
