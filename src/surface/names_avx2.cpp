// For processors with AVX2, where the build knows how to compile for them.
#include "surface/names_packet.h"

namespace pse::surface {

NameFunction names_for_avx2() {
  return [](const NameValues& values) { write_names(values); };
}

}  // namespace pse::surface
