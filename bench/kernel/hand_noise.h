// The 2002 noise in three dimensions written by hand, for AVX-512 with VBMI and for AVX2: the
// practical limits that compiled kernels are measured against. Same hashing, gradients and order of
// operations as noise/improved.h, so the same bits.
#pragma once

#include <cstdint>

namespace pse::bench {

bool hand_noise_runs_here();

// count is a multiple of 32.
void hand_noise(const float* x, const float* y, const float* z, float* out, std::int64_t count);
// Two vectors in flight at a time.
void hand_noise_twice(const float* x, const float* y, const float* z, float* out,
                      std::int64_t count);

// The same with AVX2.
bool hand_noise_avx2_runs_here();
void hand_noise_avx2(const float* x, const float* y, const float* z, float* out,
                     std::int64_t count);
void hand_noise_avx2_twice(const float* x, const float* y, const float* z, float* out,
                           std::int64_t count);

}  // namespace pse::bench
