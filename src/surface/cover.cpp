// Hulls to corners in the picture, their convex hull to cells.
#include "surface/cover.h"

#include <algorithm>

namespace pse::surface {

Cover::Cover(const Scene& scene, const Lens& lens)
    : width_(lens.picture_width()),
      height_(lens.picture_height()),
      columns_((static_cast<std::size_t>(width_) + cell - 1) / cell),
      rows_((static_cast<std::size_t>(height_) + cell - 1) / cell),
      cells_(columns_ * rows_) {
  std::vector<Corner> corners;
  for (std::size_t k = 0; k < scene.objects(); ++k) {
    const Object& object = scene.object(k);
    const std::vector<Hull> hulls = object.shape->hulls();
    bool known = !hulls.empty();
    for (std::size_t h = 0; known && h < hulls.size(); ++h) {
      // A pixel of room, and what coordinates lose where meshes are met in single precision.
      double room = 1;
      corners.clear();
      for (const Vec3& own : hulls[h]) {
        const Vec3 point = object.to_world.point(own);
        const Lens::Seen seen = lens.project(point);
        corners.push_back({seen.x, seen.y});
        room = std::max(room, 1 + 1e-6 * (length(point) + length(lens.eye())) / seen.pixel);
        known = known && seen.pixel > 0 && std::isfinite(room) && std::isfinite(seen.x) &&
                std::isfinite(seen.y);
      }
      if (known) add(corners, room);
    }
    if (known) continue;
    cells_.assign(cells_.size(), 1);
    return;
  }
}

namespace {

// The corners' outline on one side, downward: the convex hull after Andrew, with y for x. `corners`
// are sorted by y; `side`: 1 for the right one, -1 for the left.
template <class Corner>
std::vector<Corner> outline(const std::vector<Corner>& corners, double side) {
  std::vector<Corner> line;
  for (const Corner& next : corners) {
    while (line.size() >= 2) {
      const Corner &a = line[line.size() - 2], &b = line.back();
      const double turn = (b.x - a.x) * (next.y - a.y) - (next.x - a.x) * (b.y - a.y);
      if (side * turn > 0) break;
      line.pop_back();
    }
    line.push_back(next);
  }
  return line;
}

}  // namespace

void Cover::add(std::vector<Corner>& corners, double room) {
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
  });
  const std::vector<Corner> sides[] = {outline(corners, -1), outline(corners, 1)};
  const auto cell_of = [](double place, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(place / double(cell), 0.0, double(count)));
  };
  const std::size_t last_row = cell_of(corners.back().y + room + double(cell), rows_);
  for (std::size_t row = cell_of(corners.front().y - room, rows_); row < last_row; ++row) {
    // How far the hull reaches in this row of cells.
    const double top = double(row * cell) - room, bottom = double((row + 1) * cell) + room;
    Span1 reach{Box::inf, -Box::inf};
    for (const std::vector<Corner>& side : sides)
      for (std::size_t i = 0; i + 1 < side.size(); ++i) {
        const Corner &a = side[i], &b = side[i + 1];
        if (a.y > bottom || b.y < top) continue;
        const auto at = [&](double y) { return a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x); };
        for (const double x : {a.y >= top ? a.x : at(top), b.y <= bottom ? b.x : at(bottom)})
          reach.begin = std::min(reach.begin, x), reach.end = std::max(reach.end, x);
      }
    if (reach.begin > reach.end) continue;
    const std::size_t begin = cell_of(reach.begin - room, columns_),
                      end = cell_of(reach.end + room + double(cell), columns_);
    std::fill(cells_.begin() + std::ptrdiff_t(row * columns_ + begin),
              cells_.begin() + std::ptrdiff_t(row * columns_ + std::max(begin, end)), 1);
  }
}

}  // namespace pse::surface
