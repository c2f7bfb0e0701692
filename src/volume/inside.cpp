// Counting edges; casting one line of voxels after the other.
#include "volume/inside.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace pse::volume {
namespace {

// A line of voxels misses edges and corners of ordinary meshes by this part of a voxel.
constexpr double aside[3] = {1.2345e-4, 2.6789e-4, 3.9876e-4};
constexpr int majority = 4;  // of six directions

// Where a line crosses the surface, and how its winding changes there.
struct Crossing {
  float at;
  int change;
};

}  // namespace

std::int64_t open_edges(const MeshView& mesh) {
  // One number per place.
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> place;
  for (const auto& point : mesh.points)
    place.push_back(
        places.emplace(point, static_cast<std::uint32_t>(places.size())).first->second);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto a = place[triangle[c]], b = place[triangle[(c + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  std::int64_t open = 0;
  for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
    for (next = i; next < edges.size() && edges[next] == edges[i];) ++next;
    open += next - i == 2 ? 0 : 1;
  }
  return open;
}

InsideVote::InsideVote(const MeshView& mesh, const std::array<double, 3>& origin, double voxel,
                       const std::array<int, 3>& size)
    : size_(size),
      votes_(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
             static_cast<std::size_t>(size[2])) {
  for (std::size_t axis = 0; axis < 3; ++axis) cast(mesh, origin, voxel, axis);
}

bool InsideVote::inside(int i, int j, int k) const {
  if (i < 0 || j < 0 || k < 0 || i >= size_[0] || j >= size_[1] || k >= size_[2]) return false;
  return votes_[static_cast<std::size_t>((std::int64_t{i} * size_[1] + j) * size_[2] + k)] >=
         majority;
}

void InsideVote::cast(const MeshView& mesh, const std::array<double, 3>& origin, double voxel,
                      std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<std::vector<Crossing>> lines(static_cast<std::size_t>(size_[u]) *
                                           static_cast<std::size_t>(size_[v]));

  // Each triangle crosses the lines that pass through its projection along the axis.
  for (const auto& triangle : mesh.triangles) {
    std::array<std::array<double, 3>, 3> p{};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t a = 0; a < 3; ++a)
        p[c][a] = (double{mesh.points[triangle[c]][a]} - origin[a]) / voxel;
    const double area = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) -
                        (p[2][u] - p[0][u]) * (p[1][v] - p[0][v]);
    if (area == 0 || !std::isfinite(area)) continue;
    const auto range = [&](std::size_t a, double offset) {
      const auto [low, high] = std::minmax({p[0][a], p[1][a], p[2][a]});
      return std::pair(std::max(0, static_cast<int>(std::ceil(low - offset))),
                       std::min(size_[a] - 1, static_cast<int>(std::floor(high - offset))));
    };
    const auto [u0, u1] = range(u, aside[u]);
    const auto [v0, v1] = range(v, aside[v]);
    for (int a = u0; a <= u1; ++a)
      for (int b = v0; b <= v1; ++b) {
        const double x = a + aside[u], y = b + aside[v];
        // Barycentric coordinates of the line.
        std::array<double, 3> weight{};
        bool hit = true;
        for (std::size_t c = 0; c < 3; ++c) {
          const auto &q = p[(c + 1) % 3], &r = p[(c + 2) % 3];
          weight[c] = ((q[u] - x) * (r[v] - y) - (r[u] - x) * (q[v] - y)) / area;
          hit = hit && weight[c] >= 0;
        }
        if (!hit) continue;
        const double at =
            weight[0] * p[0][axis] + weight[1] * p[1][axis] + weight[2] * p[2][axis];
        lines[static_cast<std::size_t>(std::int64_t{a} * size_[v] + b)].push_back(
            {static_cast<float>(at), area < 0 ? 1 : -1});
      }
  }

  // Along each line: enclosed when what was crossed up to a voxel does not cancel.
  for (int a = 0; a < size_[u]; ++a)
    for (int b = 0; b < size_[v]; ++b) {
      auto& line = lines[static_cast<std::size_t>(std::int64_t{a} * size_[v] + b)];
      std::sort(line.begin(), line.end(), [](const Crossing& l, const Crossing& r) {
        return l.at < r.at || (l.at == r.at && l.change > r.change);
      });
      int total = 0;
      for (const Crossing& crossing : line) total += crossing.change;
      std::size_t next = 0;
      int winding = 0;
      for (int i = 0; i < size_[axis]; ++i) {
        for (; next < line.size() && line[next].at < static_cast<float>(i); ++next)
          winding += line[next].change;
        std::array<int, 3> voxel_at{};
        voxel_at[axis] = i, voxel_at[u] = a, voxel_at[v] = b;
        auto& votes = votes_[static_cast<std::size_t>(
            (std::int64_t{voxel_at[0]} * size_[1] + voxel_at[1]) * size_[2] + voxel_at[2])];
        votes = static_cast<std::uint8_t>(votes + (winding != 0) + (total - winding != 0));
      }
    }
}

}  // namespace pse::volume
