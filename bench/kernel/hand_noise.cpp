// The whole 256-entry permutation in four registers, gradients picked from three more. DESIGN.md,
// section 7.
#include "hand_noise.h"

#include <immintrin.h>

#include <cstring>

#include "noise/tables.h"

namespace pse::bench {
namespace {

struct Tables {
  __m512i p[4];
  __m512 g[3];
};

Tables load_tables() {
  Tables t;
  for (int i = 0; i < 4; ++i) t.p[i] = _mm512_loadu_si512(num::permutation.entries.data() + 64 * i);
  for (std::size_t i = 0; i < 3; ++i)
    t.g[i] = _mm512_loadu_ps(num::gradient_tables(3)[i].entries.data());
  return t;
}

inline __m512i permute(const Tables& t, __m512i i) {
  const __m512i low = _mm512_permutex2var_epi8(t.p[0], i, t.p[1]);
  const __m512i high = _mm512_permutex2var_epi8(t.p[2], i, t.p[3]);
  return _mm512_mask_blend_epi8(_mm512_movepi8_mask(i), low, high);
}

inline __m512 fade(__m512 t) {
  const __m512 inner = _mm512_fmadd_ps(
      t, _mm512_fmadd_ps(t, _mm512_set1_ps(6), _mm512_set1_ps(-15)), _mm512_set1_ps(10));
  return _mm512_mul_ps(_mm512_mul_ps(_mm512_mul_ps(t, t), t), inner);
}

inline __m512i lattice(__m512 corner) {
  const __m512i byte = _mm512_and_epi32(_mm512_cvttps_epi32(corner), _mm512_set1_epi32(255));
  return _mm512_mullo_epi32(byte, _mm512_set1_epi32(0x01010101));
}

inline __m512 noise(const Tables& t, __m512 x, __m512 y, __m512 z) {
  const __m512 cx = _mm512_roundscale_ps(x, 0x09), cy = _mm512_roundscale_ps(y, 0x09),
               cz = _mm512_roundscale_ps(z, 0x09);
  const __m512 one = _mm512_set1_ps(1);
  const __m512 x0 = _mm512_sub_ps(x, cx), y0 = _mm512_sub_ps(y, cy), z0 = _mm512_sub_ps(z, cz);
  const __m512 x1 = _mm512_sub_ps(x0, one), y1 = _mm512_sub_ps(y0, one),
               z1 = _mm512_sub_ps(z0, one);

  __m512i h = permute(t, _mm512_add_epi8(lattice(cx), _mm512_set1_epi32(0x01000100)));
  h = permute(t, _mm512_add_epi8(h, _mm512_add_epi8(lattice(cy), _mm512_set1_epi32(0x01010000))));
  const __m512i low = _mm512_add_epi8(h, lattice(cz));
  const __m512i corners[2] = {permute(t, low),
                              permute(t, _mm512_add_epi8(low, _mm512_set1_epi32(0x01010101)))};

  const __m512 u = fade(x0), v = fade(y0), w = fade(z0);
  __m512 edge[4];
  for (int i = 0; i < 4; ++i) {
    const __m512i word = corners[i >> 1];
    const __m512i a = i & 1 ? _mm512_srli_epi32(word, 16) : word,
                  b = _mm512_srli_epi32(word, i & 1 ? 24 : 8);
    const __m512 yy = i & 1 ? y1 : y0, zz = i >> 1 ? z1 : z0;
    const auto gradient = [&](int axis, __m512i index) {
      return _mm512_permutexvar_ps(index, t.g[axis]);
    };
    const __m512 at_low = _mm512_fmadd_ps(
        gradient(0, a), x0, _mm512_fmadd_ps(gradient(1, a), yy, _mm512_mul_ps(gradient(2, a), zz)));
    const __m512 step = _mm512_fmadd_ps(
        gradient(0, b), x1,
        _mm512_fmadd_ps(gradient(1, b), yy, _mm512_fmsub_ps(gradient(2, b), zz, at_low)));
    edge[i] = _mm512_fmadd_ps(u, step, at_low);
  }
  const __m512 near = _mm512_fmadd_ps(v, _mm512_sub_ps(edge[1], edge[0]), edge[0]);
  const __m512 far = _mm512_fmadd_ps(v, _mm512_sub_ps(edge[3], edge[2]), edge[2]);
  return _mm512_fmadd_ps(w, _mm512_sub_ps(far, near), near);
}

}  // namespace

bool hand_noise_runs_here() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512vbmi");
}

void hand_noise(const float* x, const float* y, const float* z, float* out, std::int64_t count) {
  const Tables t = load_tables();
  for (std::int64_t i = 0; i < count; i += 16) {
    _mm512_storeu_ps(
        out + i, noise(t, _mm512_loadu_ps(x + i), _mm512_loadu_ps(y + i), _mm512_loadu_ps(z + i)));
  }
}

void hand_noise_twice(const float* x, const float* y, const float* z, float* out,
                      std::int64_t count) {
  const Tables t = load_tables();
  for (std::int64_t i = 0; i < count; i += 32) {
    const __m512 a =
        noise(t, _mm512_loadu_ps(x + i), _mm512_loadu_ps(y + i), _mm512_loadu_ps(z + i));
    const __m512 b = noise(t, _mm512_loadu_ps(x + i + 16), _mm512_loadu_ps(y + i + 16),
                           _mm512_loadu_ps(z + i + 16));
    _mm512_storeu_ps(out + i, a);
    _mm512_storeu_ps(out + i + 16, b);
  }
}

}  // namespace pse::bench
