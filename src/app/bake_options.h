// The arguments of `pse bake`, understood.
#pragma once

#include "app/render_options.h"
#include "volume/bake.h"

namespace pse::app {

struct VolumeOptions {
  RenderOptions common;  // program or mesh, knobs, output, frames, how it is computed
  volume::LatticeSize size;
  std::optional<volume::Box> bounds;  // nothing: not given
  bool z_up = false;
  bool half = true;
  float band = 3;  // of distances, in voxels
  bool fit = false;  // a mesh: centred, its longest side 2
  std::size_t memory_limit = 0;
};

// Throws Failure (usage).
VolumeOptions bake_options(const Session& session);

}  // namespace pse::app
