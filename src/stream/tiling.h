// How a window is cut into tiles: row by row of tiles, the last ones smaller.
#pragma once

#include <algorithm>

#include "stream/executor.h"

namespace pse {

class Tiling {
 public:
  Tiling(const Rect& window, int tile_width, int tile_height)
      : window_(window),
        tile_width_(std::clamp(tile_width, 1, std::max(window.width(), 1))),
        tile_height_(std::clamp(tile_height, 1, std::max(window.height(), 1))),
        columns_((std::max(window.width(), 0) + tile_width_ - 1) / tile_width_),
        rows_((std::max(window.height(), 0) + tile_height_ - 1) / tile_height_) {}

  std::int64_t count() const { return std::int64_t{columns_} * rows_; }
  std::int64_t largest() const { return std::int64_t{tile_width_} * tile_height_; }

  Rect rect(std::int64_t tile) const {
    const int x0 = window_.x0 + static_cast<int>(tile % columns_) * tile_width_;
    const int y0 = window_.y0 + static_cast<int>(tile / columns_) * tile_height_;
    return {x0, y0, std::min(x0 + tile_width_, window_.x1),
            std::min(y0 + tile_height_, window_.y1)};
  }

 private:
  Rect window_;
  int tile_width_, tile_height_;
  int columns_, rows_;
};

}  // namespace pse
