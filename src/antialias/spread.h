// Points that fill the unit square evenly: the first two dimensions of Sobol's sequence, shifted
// by bits that two numbers give. Any 2^k of them from a multiple of 2^k on have one point in each
// box of the dyadic grids of 2^k boxes.
#pragma once

#include <array>
#include <cstdint>

#include "noise/number.h"
#include "noise/seed.h"

namespace pse::antialias {

class Spread {
 public:
  Spread(std::int32_t x, std::int32_t y) {
    const num::Int column = num::scatter<num::Int>(num::Int(x));
    const num::Int both = num::scatter<num::Int>(column ^ num::Int(y));
    shift_x_ = both.bits();
    shift_y_ = num::scatter<num::Int>(both + num::Int(1)).bits();
  }

  // Point i, both in [0, 1).
  std::array<float, 2> operator()(std::uint32_t i) const {
    return {unit(reversed(i) ^ shift_x_), unit(sobol(i) ^ shift_y_)};
  }

 private:
  static std::uint32_t reversed(std::uint32_t i) {
    std::uint32_t bits = 0;
    for (std::uint32_t bit = 0x80000000u; i != 0; i >>= 1, bit >>= 1)
      if (i & 1) bits |= bit;
    return bits;
  }
  static std::uint32_t sobol(std::uint32_t i) {
    std::uint32_t bits = 0;
    for (std::uint32_t direction = 0x80000000u; i != 0; i >>= 1, direction ^= direction >> 1)
      if (i & 1) bits ^= direction;
    return bits;
  }
  // The middle of a step of 2^-24, so never 0 or 1.
  static float unit(std::uint32_t bits) {
    return (static_cast<float>(bits >> 9) + 0.5f) * 0x1p-23f;
  }

  std::uint32_t shift_x_ = 0, shift_y_ = 0;
};

}  // namespace pse::antialias
