// The part of a picture in which a scene may be seen, so that no ray is sent where there is nothing
// but background: the objects' hulls seen through the lens, as cells of the picture that they
// reach. Between places in the picture and rays in the flow of a surface picture.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/scene.h"

namespace pse::surface {

class Cover {
 public:
  // Of a picture of the lens' size. All of it where an object has no end or comes up to the eye.
  Cover(const Scene& scene, const Lens& lens);

  // False only where the ray through this place, in pixels, meets nothing. True outside the
  // picture.
  bool may_show(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < width_ && y < height_)) return true;
    const auto column = static_cast<std::size_t>(x) / cell,
               row = static_cast<std::size_t>(y) / cell;
    return cells_[row * columns_ + column] != 0;
  }

 private:
  static constexpr std::size_t cell = 8;  // pixels along each side
  struct Corner {
    double x, y;  // in the picture
  };
  // Adds all that lies within `room` pixels of the convex hull of the corners.
  void add(std::vector<Corner>& corners, double room);

  double width_, height_;
  std::size_t columns_, rows_;
  std::vector<std::uint8_t> cells_;  // row by row, 1 where something may be seen
};

}  // namespace pse::surface
