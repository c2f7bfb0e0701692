// Triangle meshes as distances, by OpenVDB's conversion.
#include <openvdb/tools/MeshToVolume.h>

#include "volume/modules/parts.h"

namespace pse::volume {
namespace {

// The mesh as the conversion asks for it, in voxels of the grid.
class Adapter {
 public:
  Adapter(const MeshView& mesh, const openvdb::math::Transform& transform)
      : mesh_(mesh), transform_(transform) {}
  std::size_t polygonCount() const { return mesh_.triangles.size(); }
  std::size_t pointCount() const { return mesh_.points.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& place) const {
    const auto& point = mesh_.points[mesh_.triangles[polygon][corner]];
    place = transform_.worldToIndex(openvdb::Vec3d(point[0], point[1], point[2]));
  }

 private:
  const MeshView& mesh_;
  const openvdb::math::Transform& transform_;
};

struct Interrupter {
  const std::function<bool()>& keep_on;
  void start(const char* = nullptr) {}
  void end() {}
  bool wasInterrupted(int = -1) { return keep_on && !keep_on(); }
};

}  // namespace

Result<void> add_mesh_to(GridWriter& to, const MeshView& mesh, float band,
                         const std::function<bool(int, int, int)>& inside,
                         const std::function<bool()>& keep_on) {
  try {
    openvdb::FloatGrid& grid = float_grid_of(to, 0);
    Interrupter interrupter{keep_on};
    const auto made = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interrupter, Adapter(mesh, grid.transform()), grid.transform(), band, band,
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
