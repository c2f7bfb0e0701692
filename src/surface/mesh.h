// Triangle meshes as plain arrays, and a mesh as a shape. Reading files and finding the triangle
// that a ray meets are the business of a shared module (modules/mesh_tools.cpp, the home of Assimp
// and Embree), which is opened when the first mesh is.
#pragma once

#include <cstdint>
#include <expected>
#include <string>

#include "surface/shape.h"

namespace pse::surface {

struct Mesh {
  std::vector<float> positions;          // x y z of each vertex
  std::vector<float> normals;            // the same; empty where the file has none
  std::vector<float> uvs;                // u v of each vertex, v upward; empty where there are none
  std::vector<std::uint32_t> triangles;  // three vertices each, counter-clockwise seen from outside

  std::size_t vertex_count() const { return positions.size() / 3; }
  std::size_t triangle_count() const { return triangles.size() / 3; }
  Vec3 position(std::uint32_t vertex) const {
    const float* p = &positions[3 * std::size_t{vertex}];
    return {p[0], p[1], p[2]};
  }
  Box bounds() const;
};

struct MeshOptions {
  bool fit = false;      // moved and scaled so that it is centred and its longest side is 2
  double crease = 60;    // degrees; where a mesh has no normals, edges sharper than this stay sharp
  std::size_t most_triangles = 32'000'000;         // of binary PLY
  std::size_t most_library_triangles = 4'000'000;  // of all others, which Assimp reads
};

struct LoadedMesh {
  std::shared_ptr<const Mesh> mesh;  // with normals, without faults
  std::vector<std::string> notes;    // what was left out of it, a sentence each
};

// Reads OBJ, PLY or glTF. The error is a sentence that names the file and says what to do.
std::expected<LoadedMesh, std::string> load_mesh(const std::string& file,
                                                 const MeshOptions& options = {});

// Drops what cannot be used and says so; an error where nothing is left. For load_mesh and tests.
std::expected<std::vector<std::string>, std::string> clean_mesh(Mesh& mesh);
// Gives every corner the mean of its neighbours' faces, weighted by angle, across edges that bend
// less than `crease` degrees. Vertices with several normals are doubled.
void derive_normals(Mesh& mesh, double crease);

std::expected<std::shared_ptr<const Shape>, std::string> make_mesh_shape(
    std::shared_ptr<const Mesh> mesh);

// What the shared module does.
struct TriangleHit {
  std::uint32_t triangle = no_triangle;
  static constexpr std::uint32_t no_triangle = 0xffffffff;
};
class TriangleTree {
 public:
  virtual ~TriangleTree() = default;
  // The triangle that each ray meets first, as far as single precision tells; of several at the
  // same distance, the one with the least number. It depends on the ray alone. Fastest where each
  // 16 rays in a row lie side by side, and 8 of them too.
  virtual void first(std::span<const Ray> rays, std::span<TriangleHit> hits) const = 0;
};
class MeshTools {
 public:
  virtual ~MeshTools() = default;
  // False with a sentence in `error`.
  virtual bool read(const std::string& file, Mesh& mesh, std::string& error) const = 0;
  // Null with a sentence in `error`. The mesh must outlive the tree.
  virtual TriangleTree* build(const Mesh& mesh, std::string& error) const = 0;
};
inline constexpr const char* mesh_tools_entry = "pse_mesh_tools";
using MeshToolsEntry = MeshTools* (*)();

}  // namespace pse::surface
