// A hierarchy over boxes, asked by many rays at once: rays that lie side by side go down it
// together, each as far as its own way leads. What a scene's many objects are found by
// (surface/scene.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/shape.h"

namespace pse::surface {

class BoxTree {
 public:
  // Of bounded boxes.
  explicit BoxTree(std::span<const Box> boxes);

  // Calls leaf(box, which) for boxes that rays may enter before `nearest`, in some order; `which`
  // are indices of the rays that do. leaf may lower nearest. A ray is given for every box that it
  // meets before or at nearest, whatever the other rays are.
  template <class Leaf>
  void visit(std::span<const Ray> rays, std::vector<std::uint32_t> all,
             std::span<const double> nearest, const Leaf& leaf) const {
    if (nodes_.empty() || all.empty()) return;
    Walk walk{rays, nearest, {}, std::move(all)};
    walk.inverse.reserve(rays.size());
    for (const Ray& ray : rays)
      walk.inverse.push_back({1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z});
    descend(walk, 0, 0, walk.lists.size(), leaf);
  }

 private:
  struct Node {
    Box box;                  // a little larger than what it holds
    std::uint32_t child = 0;  // the second; the first stands behind its parent. 0: a leaf
    std::uint32_t index = 0;  // of a leaf: the box
    int axis = 0;             // the second child lies further along it
  };
  struct Walk {
    std::span<const Ray> rays;
    std::span<const double> nearest;
    std::vector<Vec3> inverse;         // of directions
    std::vector<std::uint32_t> lists;  // of rays, one behind the other as the walk goes down
  };

  static bool enters(const Ray& ray, const Vec3& inverse, const Box& box, double nearest) {
    double begin = ray.begin, end = std::min(ray.end, nearest);
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.lower[axis] - ray.origin[axis]) * inverse[axis],
                   b = (box.upper[axis] - ray.origin[axis]) * inverse[axis];
      // 0 times infinity, along a face, narrows nothing.
      if (!(a == a && b == b)) continue;
      const double in = a < b ? a : b, out = a < b ? b : a;
      if (in > begin) begin = in;
      if (out < end) end = out;
    }
    return begin <= end + 1e-9 * std::abs(end);
  }

  // The rays lists[begin, end) have come to the node.
  template <class Leaf>
  void descend(Walk& walk, std::uint32_t at, std::size_t begin, std::size_t end,
               const Leaf& leaf) const {
    const Node& node = nodes_[at];
    const std::size_t first = walk.lists.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t ray = walk.lists[i];
      if (enters(walk.rays[ray], walk.inverse[ray], node.box, walk.nearest[ray]))
        walk.lists.push_back(ray);
    }
    const std::size_t last = walk.lists.size();
    if (last > first) {
      if (node.child == 0) {
        leaf(node.index, std::span<const std::uint32_t>(walk.lists).subspan(first, last - first));
      } else {
        // First the child that the first ray comes to first.
        const bool forward = walk.rays[walk.lists[first]].direction[node.axis] >= 0;
        descend(walk, forward ? at + 1 : node.child, first, last, leaf);
        descend(walk, forward ? node.child : at + 1, first, last, leaf);
      }
    }
    walk.lists.resize(first);
  }

  void build(std::span<std::uint32_t> which, std::span<const Box> boxes);

  std::vector<Node> nodes_;
};

}  // namespace pse::surface
