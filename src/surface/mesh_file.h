// A look at a mesh file before a library reads it: what it is, and how much is in it. Readers of
// meshes take many times a file's size in memory, so what is too large is refused by its own count.
#pragma once

#include <cstddef>
#include <string>

namespace pse::surface {

// What is wrong with the file, or nothing.
std::string look_at_mesh_file(const std::string& file, std::size_t most_triangles);

std::string too_many_triangles(std::size_t count, std::size_t most);

}  // namespace pse::surface
