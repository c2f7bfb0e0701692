// For every processor.
#include "antialias/neighbours.h"

namespace pse::antialias {

SearchFunction search_for_any(int reach) { return search<8>(reach); }

}  // namespace pse::antialias
