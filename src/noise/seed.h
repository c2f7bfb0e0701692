// From a seed, any number a program gives, to the key that the lattice hashes mix in. Seed 0 has
// key 0: the reference.
#pragma once

#include "noise/number.h"

namespace pse::num {

// Scatters 32 bits: every bit of the result depends on every bit of h, no two h give the same, and
// 0 gives 0. (The multipliers are those that a public search for the least biased mixing of this
// form found.)
template <class I>
I scatter(I h) {
  h = (h ^ (h >> I(16))) * I(word(0x21f0aaadu));
  h = (h ^ (h >> I(15))) * I(word(0xd35a2d97u));
  return h ^ (h >> I(15));
}

// The key of a seed. -0 is 0, and every NaN is the same seed.
template <class F>
IntOf<F> key_of_seed(const F& seed) {
  using I = IntOf<F>;
  return scatter<I>(select(seed == seed, bits(seed + 0.0f), I(0x7fc00000)));
}

}  // namespace pse::num
