// For any processor; and the choice.
#include "surface/names_packet.h"

namespace pse::surface {

NameFunction names_for_any() {
  return [](const NameValues& values) { write_names(values); };
}

NameFunction name_function() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) return names_for_avx2();
#endif
  return names_for_any();
}

}  // namespace pse::surface
