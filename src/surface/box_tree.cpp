// Building the hierarchy: halves by the boxes' centres along the longest side.
#include "surface/box_tree.h"

#include <numeric>

namespace pse::surface {

BoxTree::BoxTree(std::span<const Box> boxes) {
  if (boxes.empty()) return;
  std::vector<std::uint32_t> which(boxes.size());
  std::iota(which.begin(), which.end(), 0u);
  nodes_.reserve(2 * boxes.size() - 1);
  build(which, boxes);
}

void BoxTree::build(std::span<std::uint32_t> which, std::span<const Box> boxes) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  Box around, centres;
  for (const std::uint32_t box : which) {
    around.add(boxes[box]);
    centres.add(boxes[box].centre());
  }
  // Rounding must not hide what touches its box from inside.
  const double size = std::max(length(around.lower), length(around.upper));
  const Vec3 room = (1e-9 * size) * Vec3{1, 1, 1};
  nodes_[at].box = {around.lower - room, around.upper + room};
  if (which.size() == 1) {
    nodes_[at].index = which.front();
    return;
  }
  const Vec3 extent = centres.upper - centres.lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = which.size() / 2;
  std::nth_element(which.begin(), which.begin() + static_cast<std::ptrdiff_t>(half), which.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = boxes[a].centre()[axis], y = boxes[b].centre()[axis];
                     return x < y || (x == y && a < b);
                   });
  nodes_[at].axis = axis;
  build(which.first(half), boxes);
  nodes_[at].child = static_cast<std::uint32_t>(nodes_.size());
  build(which.subspan(half), boxes);
}

}  // namespace pse::surface
