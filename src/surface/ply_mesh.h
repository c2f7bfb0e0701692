// Large binary PLY files, as scanners write them, straight into a mesh's arrays.
#pragma once

#include <expected>
#include <string>

#include "surface/mesh.h"

namespace pse::surface {

// Reads triangles and quadrilaterals; takes as much memory as the mesh does, and a megabyte. Trusts
// nothing that the file says of itself: indices may still be beyond the vertices and numbers may be
// NaN (clean_mesh()), but all counts have been held against what came. False, and the mesh is
// empty, where the file is another kind of PLY: ASCII, with larger polygons, without x, y and z.
// Errors are sentences without the file's name.
std::expected<bool, std::string> read_binary_ply(const std::string& file,
                                                 std::size_t most_triangles, Mesh& mesh);

}  // namespace pse::surface
