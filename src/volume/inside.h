// Inside and outside of a triangle mesh that may have holes. A closed mesh has an inside by itself;
// for one with holes each voxel asks along the three axes, in both directions, whether surfaces
// enclose it, and the majority counts. A teapot without a bottom is solid by five of six.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volume/vdb.h"

namespace pse::volume {

// Edges that do not belong to exactly two triangles, vertices at one place taken as one.
std::int64_t open_edges(const MeshView& mesh);

// The vote of every voxel of a box: voxel (i, j, k) has its centre at origin + voxel * (i, j, k).
class InsideVote {
 public:
  InsideVote(const MeshView& mesh, const std::array<double, 3>& origin, double voxel,
             const std::array<int, 3>& size);
  // False outside the box.
  bool inside(int i, int j, int k) const;

 private:
  void cast(const MeshView& mesh, const std::array<double, 3>& origin, double voxel,
            std::size_t axis);

  std::array<int, 3> size_;
  std::vector<std::uint8_t> votes_;
};

}  // namespace pse::volume
