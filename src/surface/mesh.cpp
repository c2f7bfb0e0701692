// Reading a mesh, and a mesh as a shape. The tree says which triangle a ray meets; where it meets
// it is computed here in double, so that the hit does not depend on how the tree found it.
#include "surface/mesh.h"

#include <filesystem>

#include "image/module_loader.h"
#include "surface/mesh_file.h"
#include "surface/ply_mesh.h"

namespace pse::surface {
namespace {

std::expected<const MeshTools*, std::string> mesh_tools() {
  static const std::expected<const MeshTools*, std::string> tools =
      []() -> std::expected<const MeshTools*, std::string> {
    const auto entry = image::load_module("pse_mesh_tools", mesh_tools_entry);
    if (!entry) return std::unexpected("meshes cannot be used: " + entry.error().message);
    return reinterpret_cast<MeshToolsEntry>(*entry)();
  }();
  return tools;
}

void fit(Mesh& mesh) {
  const Box box = mesh.bounds();
  const Vec3 size = box.upper - box.lower, centre = box.centre();
  const double scale = 2 / std::max({size.x, size.y, size.z, 1e-30});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.positions[i] =
        static_cast<float>((mesh.positions[i] - centre[static_cast<int>(i % 3)]) * scale);
}

// What Embree can reach.
constexpr double farthest = 1e18;

class MeshShape : public Shape {
 public:
  MeshShape(std::shared_ptr<const Mesh> mesh, std::unique_ptr<const TriangleTree> tree)
      : mesh_(std::move(mesh)), tree_(std::move(tree)), bounds_(mesh_->bounds()) {}
  Box bounds() const override { return bounds_; }

  // A meeting's a and b weigh the second and third corner.
  void find(std::span<const Ray> rays, std::span<Meeting> meetings) const override {
    thread_local std::vector<TriangleHit> found;
    found.assign(rays.size(), {});
    tree_->first(rays, found);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (found[i].triangle != TriangleHit::no_triangle)
        meet(rays[i], found[i].triangle, meetings[i]);
  }

  void describe(std::span<const Ray> rays, std::span<const Meeting> meetings, bool,
                std::span<ShapePoint> points) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) points[i] = look(meetings[i]);
  }

 private:
  void meet(const Ray& ray, std::uint32_t triangle, Meeting& meeting) const {
    const std::uint32_t* corner = &mesh_->triangles[3 * std::size_t{triangle}];
    const Vec3 a = mesh_->position(corner[0]), ab = mesh_->position(corner[1]) - a,
               ac = mesh_->position(corner[2]) - a;
    const Vec3 flat = cross(ab, ac), from = ray.origin - a;
    const double along = dot(flat, ray.direction);
    if (along == 0) return;
    const double per_along = 1 / along, t = -dot(flat, from) * per_along;
    if (!(t > ray.begin && t < ray.end)) return;
    // Where in the triangle; on its edge where rounding went beyond.
    const Vec3 q = cross(from, ray.direction);
    double v = -dot(ac, q) * per_along, w = dot(ab, q) * per_along;
    v = std::clamp(v, 0.0, 1.0), w = std::clamp(w, 0.0, 1.0);
    if (v + w > 1) v /= v + w, w = 1 - v;
    meeting = {t, v, w, triangle};
  }

  ShapePoint look(const Meeting& meeting) const {
    const std::uint32_t* corner = &mesh_->triangles[3 * std::size_t{meeting.part}];
    const double u = 1 - meeting.a - meeting.b;
    const auto mixed = [&](const std::vector<float>& values, std::size_t stride, std::size_t k) {
      return u * values[stride * corner[0] + k] + meeting.a * values[stride * corner[1] + k] +
             meeting.b * values[stride * corner[2] + k];
    };
    const Vec3 a = mesh_->position(corner[0]);
    ShapePoint point;
    point.flat = point.normal =
        cross(mesh_->position(corner[1]) - a, mesh_->position(corner[2]) - a);
    if (!mesh_->normals.empty()) {
      const Vec3 smooth{mixed(mesh_->normals, 3, 0), mixed(mesh_->normals, 3, 1),
                        mixed(mesh_->normals, 3, 2)};
      if (dot(smooth, smooth) > 1e-12) point.normal = smooth;
      // The side that the normals call outside is the outside.
      if (dot(point.normal, point.flat) < 0) point.flat = -point.flat;
    }
    if (!mesh_->uvs.empty()) point.u = mixed(mesh_->uvs, 2, 0), point.v = mixed(mesh_->uvs, 2, 1);
    return point;
  }

  std::shared_ptr<const Mesh> mesh_;
  std::unique_ptr<const TriangleTree> tree_;
  Box bounds_;
};

}  // namespace

Box Mesh::bounds() const {
  Box box;
  for (std::size_t v = 0; v < vertex_count(); ++v)
    box.add(position(static_cast<std::uint32_t>(v)));
  return box;
}

namespace {

// The file's triangles as they stand there; the error is a sentence without the file's name.
std::expected<Mesh, std::string> read_mesh(const std::string& file, const MeshOptions& options) {
  if (const std::string problem = look_at_mesh_file(file); !problem.empty())
    return std::unexpected(problem);
  Mesh mesh;
  if (mesh_kind(file) == MeshKind::ply) {
    const auto done = read_binary_ply(file, options.most_triangles, mesh);
    if (!done) return std::unexpected(done.error());
    if (*done) return mesh;
  }
  const std::size_t most = std::min(options.most_triangles, options.most_library_triangles);
  if (const std::string problem = too_much_for_library(file, most); !problem.empty())
    return std::unexpected(problem);
  const auto tools = mesh_tools();
  if (!tools) return std::unexpected(tools.error());
  std::string error;
  if (!(*tools)->read(file, mesh, error)) return std::unexpected(error);
  if (mesh.triangle_count() > most)
    return std::unexpected(too_many_triangles(mesh.triangle_count(), most));
  return mesh;
}

}  // namespace

std::expected<LoadedMesh, std::string> load_mesh(const std::string& file,
                                                 const MeshOptions& options) try {
  auto read = read_mesh(file, options);
  if (!read) return std::unexpected(file + ": " + read.error());
  auto mesh = std::make_shared<Mesh>(std::move(*read));
  auto notes = clean_mesh(*mesh);
  if (!notes) return std::unexpected(file + ": " + notes.error());
  if (options.fit) fit(*mesh);
  const Box box = mesh->bounds();
  if (std::max({-box.lower.x, -box.lower.y, -box.lower.z, box.upper.x, box.upper.y,
                box.upper.z}) > farthest)
    return std::unexpected(
        file +
        ": the mesh reaches beyond 1e18 from the origin, where rays do not; make it "
        "smaller, or let fit do it");
  if (mesh->normals.empty()) derive_normals(*mesh, options.crease);
  for (std::string& note : *notes) note = file + ": " + note;
  return LoadedMesh{std::move(mesh), std::move(*notes)};
} catch (const std::bad_alloc&) {
  return std::unexpected(file + ": there is not enough memory for the mesh");
}

std::expected<std::shared_ptr<const Shape>, std::string> make_mesh_shape(
    std::shared_ptr<const Mesh> mesh) {
  const auto tools = mesh_tools();
  if (!tools) return std::unexpected(tools.error());
  std::string error;
  std::unique_ptr<const TriangleTree> tree((*tools)->build(*mesh, error));
  if (!tree) return std::unexpected(error);
  return std::make_shared<MeshShape>(std::move(mesh), std::move(tree));
}

}  // namespace pse::surface
