// For every processor.
#include "antialias/neighbours.h"

namespace pse::antialias {

SearchFunction search_for_any(int reach) { return reach == 1 ? search<1> : search<2>; }

}  // namespace pse::antialias
