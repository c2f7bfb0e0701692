// The C++ library's noise: the templates at float.
#include "noise/book_noise.h"
#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "noise/seed.h"
#include "pse/noise.h"

namespace pse {
namespace {

// Without a seed nothing is spent on one.
template <std::size_t N>
num::NoiseOptions<float, N> seeded(float seed) {
  num::NoiseOptions<float, N> options;
  if (seed != 0) options.key = num::key_of_seed(seed);
  return options;
}

template <std::size_t N>
float periodic(const std::array<float, N>& p, const std::array<float, N>& period, float seed) {
  auto options = seeded<N>(seed);
  options.period = period;
  return num::improved_noise(p, options);
}

template <std::size_t N>
std::array<float, N> slopes(const std::array<float, N>& p, float seed) {
  return num::gradient(num::improved_noise(num::variables(p), seeded<N>(seed)));
}

}  // namespace

float noise(float x, float seed) { return num::improved_noise(std::array{x}, seeded<1>(seed)); }
float noise(const std::array<float, 2>& p, float seed) {
  return num::improved_noise(p, seeded<2>(seed));
}
float noise(const std::array<float, 3>& p, float seed) {
  return num::improved_noise(p, seeded<3>(seed));
}
float noise(const std::array<float, 4>& p, float seed) {
  return num::improved_noise(p, seeded<4>(seed));
}

float pnoise(const std::array<float, 2>& p, const std::array<float, 2>& period, float seed) {
  return periodic(p, period, seed);
}
float pnoise(const std::array<float, 3>& p, const std::array<float, 3>& period, float seed) {
  return periodic(p, period, seed);
}
float pnoise(const std::array<float, 4>& p, const std::array<float, 4>& period, float seed) {
  return periodic(p, period, seed);
}

std::array<float, 2> dnoise(const std::array<float, 2>& p, float seed) { return slopes(p, seed); }
std::array<float, 3> dnoise(const std::array<float, 3>& p, float seed) { return slopes(p, seed); }
std::array<float, 4> dnoise(const std::array<float, 4>& p, float seed) { return slopes(p, seed); }

std::array<float, 3> vnoise(const std::array<float, 3>& p, float seed) {
  return num::improved_vector_noise(p, seeded<3>(seed));
}

float noise1985(const std::array<float, 3>& p, float seed) {
  return num::noise_1985(p, seeded<3>(seed));
}
float noise1989(const std::array<float, 3>& p, float seed) {
  return num::noise_1989(p, seeded<3>(seed));
}
float book_noise(const std::array<float, 3>& p) { return num::book_noise(p); }

}  // namespace pse
