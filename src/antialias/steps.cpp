// Who of them is asked.
#include "antialias/steps.h"

namespace pse::antialias {

const Steps& steps() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
      __builtin_cpu_supports("avx512bw") != 0)
    return steps_for_avx512();
  if (__builtin_cpu_supports("avx2") != 0) return steps_for_avx2();
#endif
  return steps_for_any();
}

}  // namespace pse::antialias
