// Reading mesh files with Assimp.
#pragma once

#include <string>

#include "surface/mesh.h"

namespace pse::surface {

// Reads in a process of its own, with limits of time and memory: what a damaged file does to the
// reader, it does there. False with a sentence in `error`.
bool read_in_child(const std::string& file, Mesh& mesh, std::string& error);

}  // namespace pse::surface
