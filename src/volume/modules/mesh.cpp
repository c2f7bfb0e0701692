// Triangle meshes as distances, by OpenVDB's conversion.
#include <openvdb/tools/MeshToVolume.h>

#include <vector>

#include "volume/modules/parts.h"

namespace pse::volume {
namespace {

// With these types the conversion stands in OpenVDB's library; others take half a minute to
// compile.
using Triangles = openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>;

class Interrupter : public openvdb::util::NullInterrupter {
 public:
  explicit Interrupter(const std::function<bool()>& keep_on) : keep_on_(keep_on) {}
  bool wasInterrupted(int) override { return keep_on_ && !keep_on_(); }

 private:
  const std::function<bool()>& keep_on_;
};

// The mesh's points in voxels of the grid.
std::vector<openvdb::Vec3s> points_in_voxels(const MeshView& mesh,
                                             const openvdb::math::Transform& transform) {
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.points.size());
  for (const auto& [x, y, z] : mesh.points)
    points.emplace_back(transform.worldToIndex(openvdb::Vec3d(x, y, z)));
  return points;
}

}  // namespace

Result<void> add_mesh_to(GridWriter& to, const MeshView& mesh, float band,
                         const std::function<bool(int, int, int)>& inside,
                         const std::function<bool()>& keep_on) {
  try {
    openvdb::FloatGrid& grid = float_grid_of(to, 0);
    Interrupter interrupter(keep_on);
    const std::vector<openvdb::Vec3s> points = points_in_voxels(mesh, grid.transform());
    std::vector<openvdb::Vec3I> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
    const auto made = openvdb::tools::meshToVolume<openvdb::FloatGrid, Triangles,
                                                   openvdb::util::NullInterrupter>(
        interrupter, Triangles(points, triangles), grid.transform(), band, band,
        inside ? openvdb::tools::UNSIGNED_DISTANCE_FIELD : 0);
    if (inside)
      for (auto voxel = made->beginValueOn(); voxel; ++voxel) {
        const openvdb::Coord at = voxel.getCoord();
        if (inside(at.x(), at.y(), at.z())) voxel.setValue(-*voxel);
      }
    grid.setTree(made->treePtr());
    return {};
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory for the mesh's distances");
  } catch (const std::exception& problem) {
    return fail(ErrorKind::damaged, std::string("the mesh cannot be turned into distances: ") +
                                        problem.what());
  }
}

}  // namespace pse::volume
