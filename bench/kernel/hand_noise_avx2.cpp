// The permutation as sixteen rows of 16 bytes, shuffled and blended; gradients as the top bytes of
// their halves, times doubled places. docs/decisions/2026-11-28-noise-with-avx2.md.
#include <immintrin.h>

#include <array>
#include <utility>

#include "hand_noise.h"
#include "noise/tables.h"

namespace pse::bench {
namespace {

using F = __m256;
using I = __m256i;

struct alignas(32) Row {
  std::array<std::uint8_t, 32> bytes;
  I load() const { return _mm256_load_si256(reinterpret_cast<const I*>(bytes.data())); }
};

// Rows 0 to 15 are the permutation; shared rows have the low halves of two rows' entries in one
// byte; gradients are bytes; pairs are the entries of a coordinate and of the next, twice.
struct Tables {
  std::array<Row, 16> whole;
  std::array<Row, 8> shared;
  std::array<Row, 3> gradient;
  std::array<std::int32_t, 256> pairs;
};

Tables make_tables() {
  Tables t;
  for (std::size_t i = 0; i < 256; ++i) {
    const std::uint32_t low = num::permutation.entries[i],
                        high = num::permutation.entries[(i + 1) & 255];
    t.pairs[i] = static_cast<std::int32_t>((low | high << 8) * 0x00010001u);
  }
  for (std::size_t i = 0; i < 32; ++i) {
    const auto entry = [&](std::size_t row) { return num::permutation.entries[16 * row + i % 16]; };
    for (std::size_t row = 0; row < 16; ++row) t.whole[row].bytes[i] = entry(row);
    for (std::size_t row = 0; row < 8; ++row) {
      t.shared[row].bytes[i] =
          static_cast<std::uint8_t>((entry(2 * row) & 15) | (entry(2 * row + 1) << 4));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float g = num::gradient_tables(3)[axis].entries[i % 16];
      t.gradient[axis].bytes[i] = g == 0 ? 0 : g > 0 ? 0x3f : 0xbf;
    }
  }
  return t;
}

// `count` words at once share the loads of the rows.
template <std::size_t count>
struct Words {
  I word[count];
  I& operator[](std::size_t i) { return word[i]; }
  const I& operator[](std::size_t i) const { return word[i]; }
};

inline I choose(I mask, I yes, I no) { return _mm256_blendv_epi8(no, yes, mask); }
inline I flip_top(I x) { return _mm256_xor_si256(x, _mm256_set1_epi8(-128)); }

// Rows [first, first + 2^levels) by the bits above the low four; `masks` has the highest bit last.
template <std::size_t levels, std::size_t count>
inline Words<count> choose_row(const Row* first, const Words<count>& low,
                               const Words<count>* masks) {
  Words<count> result;
  if constexpr (levels == 0) {
    for (std::size_t i = 0; i < count; ++i) result[i] = _mm256_shuffle_epi8(first->load(), low[i]);
  } else {
    const auto no = choose_row<levels - 1>(first, low, masks);
    const auto yes = choose_row<levels - 1>(first + (1u << (levels - 1)), low, masks);
    for (std::size_t i = 0; i < count; ++i) result[i] = choose(masks[levels - 1][i], yes[i], no[i]);
  }
  return result;
}

template <std::size_t count>
inline Words<count> permute(const Tables& tables, const Words<count>& x) {
  Words<count> masks[3], other;
  for (std::size_t i = 0; i < count; ++i) {
    masks[0][i] = _mm256_slli_epi32(x[i], 3);
    masks[1][i] = _mm256_slli_epi32(x[i], 2);
    masks[2][i] = _mm256_add_epi32(x[i], x[i]);
    other[i] = flip_top(x[i]);
  }
  const auto below = choose_row<3>(&tables.whole[0], x, masks),
             above = choose_row<3>(&tables.whole[8], other, masks);
  Words<count> result;
  for (std::size_t i = 0; i < count; ++i) result[i] = _mm256_or_si256(below[i], above[i]);
  return result;
}

// Only the low half of each byte is right.
template <std::size_t count>
inline Words<count> permute_low(const Tables& tables, const Words<count>& x) {
  Words<count> masks[2], other;
  for (std::size_t i = 0; i < count; ++i) {
    masks[0][i] = _mm256_slli_epi32(x[i], 2);
    masks[1][i] = _mm256_add_epi32(x[i], x[i]);
    other[i] = flip_top(x[i]);
  }
  const auto below = choose_row<2>(&tables.shared[0], x, masks),
             above = choose_row<2>(&tables.shared[4], other, masks);
  Words<count> result;
  for (std::size_t i = 0; i < count; ++i) {
    const I even = _mm256_or_si256(below[i], above[i]);
    result[i] = choose(_mm256_slli_epi32(x[i], 3), _mm256_srli_epi32(even, 4), even);
  }
  return result;
}

inline F fade(F t) {
  const F inner = _mm256_fmadd_ps(t, _mm256_fmadd_ps(t, _mm256_set1_ps(6), _mm256_set1_ps(-15)),
                                  _mm256_set1_ps(10));
  return _mm256_mul_ps(_mm256_mul_ps(_mm256_mul_ps(t, t), t), inner);
}

// The low byte of a whole number in all four places.
inline I lattice(F corner) {
  const I low_bytes = _mm256_set_epi32(0x0c0c0c0c, 0x08080808, 0x04040404, 0, 0x0c0c0c0c,
                                       0x08080808, 0x04040404, 0);
  return _mm256_shuffle_epi8(_mm256_cvttps_epi32(corner), low_bytes);
}

// From the hashes of the four low and the four high corners.
inline F interpolate(const Tables& tables, F x0, F y0, F z0, I low_hashes, I high_hashes) {
  const F one = _mm256_set1_ps(1);
  F x1 = _mm256_sub_ps(x0, one), y1 = _mm256_sub_ps(y0, one), z1 = _mm256_sub_ps(z0, one);
  const F u = fade(x0), v = fade(y0), w = fade(z0);
  for (F* place : {&x0, &y0, &z0, &x1, &y1, &z1}) *place = _mm256_add_ps(*place, *place);
  F edge[4];
  for (int i = 0; i < 4; ++i) {
    const I word = _mm256_and_si256(i >> 1 ? high_hashes : low_hashes, _mm256_set1_epi8(15));
    const auto gradient = [&](std::size_t axis, int corner) {
      const I bytes = _mm256_shuffle_epi8(tables.gradient[axis].load(), word);
      const I top = corner == 3 ? bytes : _mm256_slli_epi32(bytes, 24 - 8 * corner);
      const I mask = _mm256_set1_epi32(static_cast<int>(0xff000000u));
      return _mm256_castsi256_ps(corner == 0 ? top : _mm256_and_si256(top, mask));
    };
    const int a = i & 1 ? 2 : 0, b = a + 1;
    const F yy = i & 1 ? y1 : y0, zz = i >> 1 ? z1 : z0;
    const F at_low = _mm256_fmadd_ps(
        gradient(0, a), x0, _mm256_fmadd_ps(gradient(1, a), yy, _mm256_mul_ps(gradient(2, a), zz)));
    const F step = _mm256_fmadd_ps(
        gradient(0, b), x1,
        _mm256_fmadd_ps(gradient(1, b), yy, _mm256_fmsub_ps(gradient(2, b), zz, at_low)));
    edge[i] = _mm256_fmadd_ps(u, step, at_low);
  }
  const F near = _mm256_fmadd_ps(v, _mm256_sub_ps(edge[1], edge[0]), edge[0]);
  const F far = _mm256_fmadd_ps(v, _mm256_sub_ps(edge[3], edge[2]), edge[2]);
  return _mm256_fmadd_ps(w, _mm256_sub_ps(far, near), near);
}

// `count` vectors of eight samples, their hashes side by side.
template <std::size_t count>
inline void noise(const Tables& tables, const float* x, const float* y, const float* z,
                  float* out) {
  const auto load = [](const float* from, std::size_t i) { return _mm256_loadu_ps(from + 8 * i); };
  const auto floor = [](F value) { return _mm256_round_ps(value, 0x09); };
  Words<count> hashes;
  for (std::size_t i = 0; i < count; ++i) {
    const I byte = _mm256_and_si256(_mm256_cvttps_epi32(floor(load(x, i))), _mm256_set1_epi32(255));
    hashes[i] = _mm256_i32gather_epi32(tables.pairs.data(), byte, 4);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const I step = _mm256_set1_epi32(0x01010000);
    hashes[i] = _mm256_add_epi8(hashes[i], _mm256_add_epi8(lattice(floor(load(y, i))), step));
  }
  hashes = permute(tables, hashes);
  for (std::size_t i = 0; i < count; ++i) {
    const I low = _mm256_add_epi8(hashes[i], lattice(floor(load(z, i))));
    const I high = _mm256_add_epi8(low, _mm256_set1_epi8(1));
    const auto place = [&](const float* from) {
      const F value = load(from, i);
      return _mm256_sub_ps(value, floor(value));
    };
    const Words<2> both = permute_low<2>(tables, {low, high});
    _mm256_storeu_ps(out + 8 * i,
                     interpolate(tables, place(x), place(y), place(z), both[0], both[1]));
  }
}

template <std::size_t count>
void loop(const float* x, const float* y, const float* z, float* out, std::int64_t samples) {
  static const Tables tables = make_tables();
  constexpr std::int64_t step = 8 * count;
  for (std::int64_t i = 0; i < samples; i += step)
    noise<count>(tables, x + i, y + i, z + i, out + i);
}

}  // namespace

bool hand_noise_avx2_runs_here() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

void hand_noise_avx2(const float* x, const float* y, const float* z, float* out,
                     std::int64_t count) {
  loop<1>(x, y, z, out, count);
}

void hand_noise_avx2_twice(const float* x, const float* y, const float* z, float* out,
                           std::int64_t count) {
  loop<2>(x, y, z, out, count);
}

}  // namespace pse::bench
