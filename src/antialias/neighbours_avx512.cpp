// For processors with AVX-512, where the build knows how to compile for them.
#include "antialias/neighbours.h"

namespace pse::antialias {

SearchFunction search_for_avx512(int reach) { return search<16>(reach); }

}  // namespace pse::antialias
