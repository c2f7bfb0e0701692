// Which loops search (decisions.h).
#pragma once

#include "antialias/decisions.h"

namespace pse::antialias {

// Enters them in `found`, whose decisions are known.
void find_searches(const ir::Function& function, Decisions& found);

// Leaves out the decisions within searches: they are of the way there, not of the end.
void leave_out_searches(const ir::Region& region, Decisions& decisions);

}  // namespace pse::antialias
