// What the noise functions share: where a point lies in its cell of the integer lattice, how the
// cell's corners are hashed, and how what the corners say is interpolated. Chapter, "Constructing
// the noise function". Corner c of a cell is its low corner moved by one along x where bit 0 of c
// is set, along y for bit 1, and so on.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "noise/dual.h"
#include "noise/number.h"
#include "noise/tables.h"

namespace pse::num {

// What a call may ask for beside the position. A period is a whole number from 1 to 256; anything
// else is rounded and cut to that, and 0 or less means 256. A key is a mixed seed (noise/seed.h).
template <class F, std::size_t N>
struct NoiseOptions {
  std::optional<std::array<BaseOf<F>, N>> period;
  std::optional<IntOf<F>> key;
};

// 6 t^5 - 15 t^4 + 10 t^3: flat in first and second derivative at 0 and 1.
template <class F>
F quintic_fade(const F& t) {
  return (t * t * t) * fma(t, fma(t, F(6.0f), F(-15.0f)), F(10.0f));
}
// Its derivative is 30 (t^2 - t)^2.
template <class F, std::size_t N>
Dual<F, N> quintic_fade(const Dual<F, N>& t) {
  const F hump = t.value * t.value - t.value;
  return t.chain(quintic_fade(t.value), (30.0f * hump) * hump);
}

// 3 t^2 - 2 t^3: flat in first derivative at 0 and 1.
template <class F>
F cubic_fade(const F& t) {
  return (t * t) * (3.0f - 2.0f * t);
}
// Its derivative is 6 (t - t^2).
template <class F, std::size_t N>
Dual<F, N> cubic_fade(const Dual<F, N>& t) {
  return t.chain(cubic_fade(t.value), 6.0f * (t.value - t.value * t.value));
}

// A point's cell and the point's place in it.
template <class F, std::size_t N>
struct Cell {
  std::array<BaseOf<F>, N> corner;         // the cell's low corner, a whole number
  std::array<std::array<F, N>, 2> offset;  // from the low and from the high corner
};

template <class F>
BaseOf<F> base_floor(const F& x) {
  return floor(x);
}
template <class F, std::size_t N>
F base_floor(const Dual<F, N>& x) {
  return floor(x.value);
}

template <class F, std::size_t N>
Cell<F, N> cell_of(const std::array<F, N>& point) {
  Cell<F, N> cell;
  for (std::size_t axis = 0; axis < N; ++axis) {
    cell.corner[axis] = base_floor(point[axis]);
    cell.offset[0][axis] = point[axis] - F(cell.corner[axis]);
    cell.offset[1][axis] = cell.offset[0][axis] - 1.0f;
  }
  return cell;
}

// One axis of a cell's corners as bytes, four corners to a word: byte k of axis 0 is for corner k
// of 0 1 0 1, of axis 1 for 0 0 1 1; a later axis has a word for its low and one for its high
// corners.
template <class I>
struct AxisBytes {
  I low;                  // axes 0 and 1: the only word
  std::optional<I> high;  // a later axis with a period; without one it is low + 1 in each byte
};

inline constexpr std::int32_t every_byte = 0x01010101;

// Lattice coordinates modulo 256.
template <class F>
AxisBytes<IntOf<F>> axis_bytes(std::size_t axis, const F& corner) {
  using I = IntOf<F>;
  const I repeated = (to_int(corner) & I(255)) * I(every_byte);
  if (axis == 0) return {bytes_add(repeated, I(0x01000100)), {}};
  if (axis == 1) return {bytes_add(repeated, I(0x01010000)), {}};
  return {repeated, {}};
}

// A cell's low and high corner on one axis, counted modulo a period of 1 to `longest`; 0 or less
// means the longest.
template <class F>
std::array<IntOf<F>, 2> wrap(const F& corner, const F& period, float longest) {
  const F rounded = round(period);
  const F whole = select(rounded > 0.0f, min(rounded, F(longest)), F(longest));
  const F low = fma(-floor(corner / whole), whole, corner);
  const F high = low + 1.0f;
  return {to_int(low), to_int(select(high == whole, F(0.0f), high))};
}

// Lattice coordinates modulo a period.
template <class F>
AxisBytes<IntOf<F>> axis_bytes(std::size_t axis, const F& corner, const F& period) {
  using I = IntOf<F>;
  const auto wrapped = wrap(corner, period, 256.0f);
  const I low = wrapped[0] & I(255), high = wrapped[1] & I(255);
  if (axis == 0) return {low * I(0x00010001) + high * I(0x01000100), {}};
  if (axis == 1) return {low * I(0x00000101) + high * I(0x01010000), {}};
  return {low * I(every_byte), high * I(every_byte)};
}

// Byte `level` of a key in all four places.
template <class I>
I key_bytes(const I& key, int level) {
  return ((key >> I(8 * level)) & I(255)) * I(every_byte);
}

// One step of the fold through a permutation; with a key, `rounds` more steps with a byte of the
// key mixed in before each, so that every key has a permutation of its own. Key 0 changes nothing.
template <class I>
I permute(const ByteTable& table, const I& word, const std::optional<I>& key, int level,
          int rounds) {
  I result = lookup(table, word);
  for (int i = 0; key && i < rounds; ++i) {
    result = select(*key == I(0), result, lookup(table, result ^ key_bytes(*key, level + i)));
  }
  return result;
}

// How far the point has come from the low to the high corner along each axis, by a fade.
template <class F, std::size_t N>
std::array<F, N> quintic_fades(const Cell<F, N>& cell) {
  std::array<F, N> fade;
  for (std::size_t axis = 0; axis < N; ++axis) fade[axis] = quintic_fade(cell.offset[0][axis]);
  return fade;
}
template <class F, std::size_t N>
std::array<F, N> cubic_fades(const Cell<F, N>& cell) {
  std::array<F, N> fade;
  for (std::size_t axis = 0; axis < N; ++axis) fade[axis] = cubic_fade(cell.offset[0][axis]);
  return fade;
}

// The hashes of a cell's corners, a byte each, four to a word: corner c in byte c mod 4 of word c
// / 4.
template <class F, std::size_t N>
using CornerHashes = std::array<IntOf<F>, N <= 2 ? 1 : (std::size_t{1} << (N - 2))>;

// Chapter, "To quickly index into G": fold the coordinates through the permutation, one axis after
// the other.
template <class F, std::size_t N>
CornerHashes<F, N> hash_corners(const std::array<F, N>& corner, const NoiseOptions<F, N>& options,
                                const ByteTable& table = permutation) {
  using I = IntOf<F>;
  // How many bytes of a key each axis takes: all four, where the words are still few.
  static constexpr int rounds[4][4] = {{4, 0, 0, 0}, {2, 2, 0, 0}, {1, 2, 1, 0}, {1, 1, 1, 1}};
  CornerHashes<F, N> words;
  std::size_t count = 1;
  int level = 0;
  for (std::size_t axis = 0; axis < N; ++axis) {
    const AxisBytes<I> bytes = options.period
                                   ? axis_bytes<F>(axis, corner[axis], (*options.period)[axis])
                                   : axis_bytes<F>(axis, corner[axis]);
    // The axis joins the words so far; from axis 2 on that doubles their number.
    if (axis == 0) words[0] = bytes.low;
    if (axis == 1) words[0] = bytes_add(words[0], bytes.low);
    if (axis >= 2) {
      for (std::size_t i = 0; i < count; ++i) {
        const I low = bytes_add(words[i], bytes.low);
        words[i + count] =
            bytes.high ? bytes_add(words[i], *bytes.high) : bytes_add(low, I(every_byte));
        words[i] = low;
      }
      count *= 2;
    }
    for (std::size_t i = 0; i < count; ++i) {
      words[i] = permute<I>(table, words[i], options.key, level, rounds[N - 1][axis]);
    }
    level += rounds[N - 1][axis];
  }
  return words;
}

// Corner c's hash, in the low byte; the bytes above are others'.
template <class I, std::size_t Count>
I corner_hash(const std::array<I, Count>& words, std::size_t c) {
  return c % 4 == 0 ? words[c / 4] : words[c / 4] >> I(static_cast<std::int32_t>(8 * (c % 4)));
}

// Interpolates what the 2^N corners say, first along x, then y, and so on. `at(c, start)` is what
// corner c says, plus *start where there is one; the difference between two neighbours is taken
// inside it, which saves an operation for each pair.
template <class F, std::size_t N, class AtCorner>
F interpolate(const std::array<F, N>& fade, const AtCorner& at) {
  constexpr std::size_t pairs = std::size_t{1} << (N - 1);
  std::array<F, pairs> values;
  for (std::size_t i = 0; i < pairs; ++i) {
    const F low = at(2 * i, nullptr);
    const F minus_low = -low;
    const F step = at(2 * i + 1, &minus_low);
    values[i] = fma(fade[0], step, low);
  }
  for (std::size_t axis = 1; axis < N; ++axis) {
    for (std::size_t i = 0; i < pairs >> axis; ++i)
      values[i] = lerp(fade[axis], values[2 * i], values[2 * i + 1]);
  }
  return values[0];
}

// The inner product of corner c's gradient with the way from that corner to the point, plus *start
// where there is one.
template <class F, std::size_t N>
F slope_at(const Cell<F, N>& cell, std::size_t c, const std::array<BaseOf<F>, N>& corner_gradient,
           const F* start) {
  const auto way = [&](std::size_t axis) -> const F& { return cell.offset[(c >> axis) & 1][axis]; };
  const F last(corner_gradient[N - 1]);
  F sum = start ? fma(last, way(N - 1), *start) : last * way(N - 1);
  for (std::size_t axis = N - 1; axis-- > 0;) sum = fma(F(corner_gradient[axis]), way(axis), sum);
  return sum;
}

}  // namespace pse::num
