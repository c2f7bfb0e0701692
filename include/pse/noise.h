// Noise for C++ programs: the numbers that the language's functions of the same names give, on
// every machine. Positions are in lattice cells. A seed of 0 is the reference noise; any other
// number gives another noise.
#pragma once

#include <array>
#include <cstddef>

namespace pse {

// The signed noise of 2002 in one to four dimensions: in [-1.1, 1.1], 0 at whole positions, period
// 256.
float noise(float x, float seed = 0);
float noise(const std::array<float, 2>& p, float seed = 0);
float noise(const std::array<float, 3>& p, float seed = 0);
float noise(const std::array<float, 4>& p, float seed = 0);

// The same with a whole period from 1 to 256 along each axis; 0 means 256.
float pnoise(const std::array<float, 2>& p, const std::array<float, 2>& period, float seed = 0);
float pnoise(const std::array<float, 3>& p, const std::array<float, 3>& period, float seed = 0);
float pnoise(const std::array<float, 4>& p, const std::array<float, 4>& period, float seed = 0);

// The gradient of noise, exact.
std::array<float, 2> dnoise(const std::array<float, 2>& p, float seed = 0);
std::array<float, 3> dnoise(const std::array<float, 3>& p, float seed = 0);
std::array<float, 4> dnoise(const std::array<float, 4>& p, float seed = 0);

// Three noises that have nothing to do with each other; the first is noise.
std::array<float, 3> vnoise(const std::array<float, 3>& p, float seed = 0);

// The noises of 1985, of 1989, and of the 2002 chapter's listing.
float noise1985(const std::array<float, 3>& p, float seed = 0);
float noise1989(const std::array<float, 3>& p, float seed = 0);
float book_noise(const std::array<float, 3>& p);

// The same for lists: noise({x, y, z}). The list's length is the dimension, 2 to 4.
template <std::size_t N>
float noise(const float (&p)[N], float seed = 0) {
  return noise(std::to_array(p), seed);
}
template <std::size_t N>
float pnoise(const float (&p)[N], const float (&period)[N], float seed = 0) {
  return pnoise(std::to_array(p), std::to_array(period), seed);
}
template <std::size_t N>
std::array<float, N> dnoise(const float (&p)[N], float seed = 0) {
  return dnoise(std::to_array(p), seed);
}

}  // namespace pse
