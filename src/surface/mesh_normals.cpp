// Normals for meshes that have none: smooth where the surface is, sharp at its edges.
#include <bit>
#include <numbers>

#include "surface/mesh.h"

namespace pse::surface {
namespace {

std::size_t hash_of(const float* place) {
  std::size_t h = 0;
  for (int k = 0; k < 3; ++k)  // + 0.0f: both zeros are one place
    h = (h ^ std::bit_cast<std::uint32_t>(place[k] + 0.0f)) * 0x9e3779b97f4a7c15ull;
  return h ^ (h >> 29);
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

constexpr std::uint32_t none = 0xffffffff;

// For each vertex the first one at the same place.
std::vector<std::uint32_t> places(const Mesh& mesh) {
  std::vector<std::uint32_t> known(std::bit_ceil(2 * mesh.vertex_count() + 1), none);
  std::vector<std::uint32_t> place(mesh.vertex_count());
  for (std::size_t v = 0; v < place.size(); ++v) {
    const float* p = &mesh.positions[3 * v];
    std::size_t at = hash_of(p) & (known.size() - 1);
    const auto is_here = [&](std::uint32_t other) {
      return std::equal(p, p + 3, &mesh.positions[3 * std::size_t{other}]);
    };
    while (known[at] != none && !is_here(known[at])) at = (at + 1) & (known.size() - 1);
    if (known[at] == none) known[at] = static_cast<std::uint32_t>(v);
    place[v] = known[at];
  }
  return place;
}

// What vertices have been given: a normal, and the next copy of the same old vertex with another.
struct Given {
  Vec3 normal;
  std::uint32_t next = none;
  bool done = false;
};

}  // namespace

void derive_normals(Mesh& mesh, double crease) {
  const std::size_t triangles = mesh.triangle_count();
  const std::vector<std::uint32_t> place = places(mesh);

  // Faces, and the corners that meet at each place.
  std::vector<Vec3> faces(triangles);
  std::vector<double> weights(3 * triangles);
  std::vector<std::uint32_t> starts(place.size() + 1, 0), corners(3 * triangles);
  for (std::size_t i = 0; i < triangles; ++i) {
    const std::uint32_t* corner = &mesh.triangles[3 * i];
    const Vec3 p[3] = {mesh.position(corner[0]), mesh.position(corner[1]),
                       mesh.position(corner[2])};
    faces[i] = normalized(cross(p[1] - p[0], p[2] - p[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      weights[3 * i + k] = angle_between(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
      ++starts[place[corner[k]] + 1];
    }
  }
  for (std::size_t i = 0; i < place.size(); ++i) starts[i + 1] += starts[i];
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  for (std::size_t c = 0; c < corners.size(); ++c)
    corners[next[place[mesh.triangles[c]]]++] = static_cast<std::uint32_t>(c);

  // Each corner takes the faces at its place that bend away less than the crease.
  const double least_cosine = std::cos(crease * std::numbers::pi / 180);
  std::vector<Given> given(mesh.vertex_count());
  mesh.normals.assign(mesh.positions.size(), 0);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t vertex = mesh.triangles[c], at = place[vertex];
    const Vec3& own = faces[c / 3];
    Vec3 sum;
    for (std::uint32_t k = starts[at]; k < starts[at + 1]; ++k)
      if (dot(own, faces[corners[k] / 3]) >= least_cosine)
        sum = sum + weights[corners[k]] * faces[corners[k] / 3];
    const Vec3 normal = normalized(dot(sum, sum) > 1e-20 ? sum : own);

    // The vertex itself takes its first normal; others go to copies of it.
    std::uint32_t to = none, last = vertex;
    for (std::uint32_t k = given[vertex].done ? vertex : none; k != none; k = given[k].next) {
      if (dot(given[k].normal, normal) > 1 - 1e-9) to = k;
      last = k;
    }
    if (to == none) {
      to = vertex;
      if (given[vertex].done) {
        to = given[last].next = static_cast<std::uint32_t>(mesh.vertex_count());
        given.push_back({});
        for (std::size_t k = 0; k < 3; ++k)
          mesh.positions.push_back(mesh.positions[3 * std::size_t{vertex} + k]),
              mesh.normals.push_back(0);
        for (std::size_t k = 0; k < 2 && !mesh.uvs.empty(); ++k)
          mesh.uvs.push_back(mesh.uvs[2 * std::size_t{vertex} + k]);
      }
      given[to] = {normal, none, true};
      for (int k = 0; k < 3; ++k)
        mesh.normals[3 * std::size_t{to} + static_cast<std::size_t>(k)] =
            static_cast<float>(normal[k]);
    }
    mesh.triangles[c] = to;
  }
}

}  // namespace pse::surface
