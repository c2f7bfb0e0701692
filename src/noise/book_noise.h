// The noise of the chapter's listing, bit for bit what that C program computes in float, kept for
// pictures made with it. Its defects are kept too: the shuffle steps by two from one past the
// table, so the table is no permutation; adding 10000 quantises positions to 2^-10 and fails below
// -10000. New work wants improved.h.
#pragma once

#include <array>
#include <cstddef>

#include "noise/lattice.h"
#include "noise/tables.h"

namespace pse::num {

// Signed noise in three dimensions, 0 at lattice points; found within [-1.04, 1.08]. No
// contraction: each product and each sum is rounded, as there. (Products that the listing takes in
// double are exact for the positions it can tell apart.)
template <class F>
F book_noise(const std::array<F, 3>& point) {
  using B = BaseOf<F>;
  using I = IntOf<B>;
  // setup: the lattice cell by truncation, and the place in it.
  Cell<F, 3> cell;
  std::array<I, 3> low;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const F t = point[axis] + 10000.0f;
    const F whole = trunc(t);
    low[axis] = (to_int(whole) & I(255)) * I(every_byte);
    cell.offset[0][axis] = t - whole;
    cell.offset[1][axis] = cell.offset[0][axis] - 1.0f;
  }

  // Fold x and y through the table; z is added, not folded.
  const I edges = lookup(book_permutation(), bytes_add(low[0], I(0x01000100)));
  const I columns = lookup(book_permutation(), bytes_add(edges, bytes_add(low[1], I(0x01010000))));
  const I below = bytes_add(columns, low[2]);
  const std::array<I, 2> hashes = {below, bytes_add(below, I(every_byte))};

  // What each corner says, then x, y, z in turn.
  const auto tables = book_gradients();
  std::array<F, 8> values;
  for (std::size_t c = 0; c < 8; ++c) {
    const I index = corner_hash(hashes, c);
    const auto term = [&](std::size_t axis) {
      return cell.offset[(c >> axis) & 1][axis] * F(lookup(tables[axis], index));
    };
    values[c] = term(0) + term(1) + term(2);
  }
  const std::array<F, 3> fade = cubic_fades(cell);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < std::size_t{4} >> axis; ++i) {
      const F a = values[2 * i], b = values[2 * i + 1];
      values[i] = a + fade[axis] * (b - a);
    }
  }
  return 1.5f * values[0];
}

}  // namespace pse::num
