// Faults of meshes: what is repaired in silence, what is left out and told, what is refused.
#include <cmath>

#include "surface/mesh.h"

namespace pse::surface {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

bool all_finite(const std::vector<float>& values, std::size_t stride, std::uint32_t vertex) {
  for (std::size_t k = 0; k < stride; ++k)
    if (!std::isfinite(values[stride * vertex + k])) return false;
  return true;
}

}  // namespace

std::expected<std::vector<std::string>, std::string> clean_mesh(Mesh& mesh) {
  if (mesh.vertex_count() == 0) return std::unexpected("the mesh has no vertices");
  if (mesh.triangles.empty())
    return std::unexpected("the mesh has no faces, only points or lines; export it with faces");

  // Normals and coordinates must be there for every vertex, and be numbers.
  const std::size_t vertices = mesh.vertex_count();
  std::vector<std::string> notes;
  if (mesh.normals.size() != 3 * vertices) mesh.normals.clear();
  if (mesh.uvs.size() != 2 * vertices) mesh.uvs.clear();
  std::size_t no_uv = 0;
  for (float& value : mesh.uvs)
    if (!std::isfinite(value)) value = 0, ++no_uv;
  if (no_uv > 0)
    notes.push_back(counted(no_uv, "texture coordinate is", "texture coordinates are") +
                    " not a number; taken for 0");
  for (float& value : mesh.normals)
    if (!std::isfinite(value)) {
      notes.emplace_back("its normals are not all numbers, so new ones were made");
      mesh.normals.clear();
      break;
    }

  // Leave out triangles that are nothing.
  std::size_t kept = 0, not_finite = 0, flat = 0, beyond = 0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    const std::uint32_t a = mesh.triangles[3 * i], b = mesh.triangles[3 * i + 1],
                        c = mesh.triangles[3 * i + 2];
    if (std::max({a, b, c}) >= vertices) {
      ++beyond;
      continue;
    }
    if (!all_finite(mesh.positions, 3, a) || !all_finite(mesh.positions, 3, b) ||
        !all_finite(mesh.positions, 3, c)) {
      ++not_finite;
      continue;
    }
    const Vec3 p = mesh.position(a), ab = mesh.position(b) - p, ac = mesh.position(c) - p;
    const double area = length(cross(ab, ac));
    if (!(area > 1e-14 * std::max(dot(ab, ab), dot(ac, ac)))) {
      ++flat;
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) mesh.triangles[3 * kept + k] = mesh.triangles[3 * i + k];
    ++kept;
  }
  mesh.triangles.resize(3 * kept);
  if (beyond > 0)
    notes.push_back(counted(beyond, "face names a vertex", "faces name vertices") +
                    " that the file does not have; left out");
  if (not_finite > 0)
    notes.push_back(counted(not_finite, "face has a corner", "faces have corners") +
                    " that is not a number; left out");
  if (flat > 0)
    notes.push_back(counted(flat, "face has", "faces have") + " no area; left out");
  if (kept == 0) {
    std::string why = "no face of the mesh can be used";
    for (const std::string& note : notes) why += "; " + note;
    return std::unexpected(why);
  }

  // Corners that no triangle has any more may still be NaN: they would spoil the bounds.
  for (float& value : mesh.positions)
    if (!std::isfinite(value)) value = 0;
  std::vector<bool> is_used(vertices, false);
  for (const std::uint32_t v : mesh.triangles) is_used[v] = true;
  const std::uint32_t some = mesh.triangles.front();
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_used[v])
      for (std::size_t k = 0; k < 3; ++k) mesh.positions[3 * v + k] = mesh.positions[3 * some + k];
  return notes;
}

}  // namespace pse::surface
