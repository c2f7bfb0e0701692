// `pse bake PROGRAM MESH -o albedo.png`: a program over the texture atlas of a mesh.
#pragma once

#include "app/session.h"

namespace pse::app {

// Whether the arguments of `pse bake` name a mesh and no volume.
bool wants_atlas(const Arguments& arguments);

// Throws Failure.
Exit bake_atlas(Session& session);

}  // namespace pse::app
