// Random numbers without memory: the same arguments give the same number, whatever else differs.
// What programs call to scatter stars, place waves and grain film; the lattice noises have hashes
// of their own.
#pragma once

#include <span>

#include "noise/seed.h"

namespace pse::num {

// A number in [0, 1), a multiple of 2^-24, that depends on every bit of every argument and on their
// order. -0 counts as 0, and every NaN as the same.
template <class F>
F random_of(std::span<const F> arguments) {
  using I = IntOf<F>;
  I state = I(word(0x9e3779b9u));
  for (const F& argument : arguments) {
    const I input = select(argument == argument, bits(argument + 0.0f), I(0x7fc00000));
    state = scatter<I>(state ^ input) + I(word(0x9e3779b9u));
  }
  return to_float(scatter<I>(state) >> I(8)) * 0x1p-24f;
}

}  // namespace pse::num
