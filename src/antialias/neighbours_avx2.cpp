// For processors with AVX2, where the build knows how to compile for them.
#include "antialias/neighbours.h"

namespace pse::antialias {

SearchFunction search_for_avx2(int reach) { return search<8>(reach); }

}  // namespace pse::antialias
