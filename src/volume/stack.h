// Pictures as the slices of a volume: `volume("slice.%04d.png", p)`. The stack lies about the
// origin, its pictures 1 high, with cubes for voxels; x points right, y up, and the first picture
// has the lowest z. Outside there is 0.
#pragma once

#include "image/layers.h"
#include "volume/vdb.h"

namespace pse::volume {

// What the slices hold; looks at the head of the first. `layer` empty: the only layer, or `color`.
Result<GridInfo> stack_info(const std::string& pattern, const std::string& layer);
Result<GridData> read_stack(const std::string& pattern, const std::string& layer,
                            std::size_t limit);

}  // namespace pse::volume
