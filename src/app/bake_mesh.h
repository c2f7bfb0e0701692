// `pse bake` of a mesh: the level set of its distances.
#pragma once

#include "app/bake_options.h"
#include "app/signals.h"

namespace pse::app {

bool is_mesh_name(const std::string& name);

// Throws Failure; returns how a stopped run should end.
Exit bake_mesh(Session& session, const VolumeOptions& options, Signals& signals);

}  // namespace pse::app
