// A look at a mesh file before it is read: what it is, and how much is in it. The library for
// meshes takes many times a file's size in memory, so what is too large for it is refused by its
// own count.
#pragma once

#include <cstddef>
#include <string>

namespace pse::surface {

enum class MeshKind { none, obj, ply, gltf };
// By the name's ending.
MeshKind mesh_kind(const std::string& file);

// What is wrong with the file, or nothing.
std::string look_at_mesh_file(const std::string& file);
// The same for a file that the library is to read.
std::string too_much_for_library(const std::string& file, std::size_t most_triangles);

std::string too_many_triangles(std::size_t count, std::size_t most);

}  // namespace pse::surface
