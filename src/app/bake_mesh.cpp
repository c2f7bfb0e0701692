// From a mesh file to distances.
#include "app/bake_mesh.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "app/bake_job.h"
#include "app/input_images.h"
#include "app/version.h"
#include "base/hash.h"
#include "surface/mesh.h"
#include "volume/inside.h"

namespace pse::app {

bool is_mesh_name(const std::string& name) {
  for (const char* ending : {".obj", ".ply", ".gltf", ".glb"})
    if (name.ends_with(ending)) return true;
  return false;
}

Exit bake_mesh(Session& session, const VolumeOptions& options, Signals& signals) {
  const RenderOptions& common = options.common;
  const std::string file = session.find_file(common.program);
  const auto vdb = volume::open_vdb();
  if (!vdb) throw Failure(Exit::output, vdb.error().message);
  surface::MeshOptions mesh_options;
  mesh_options.fit = options.fit;
  const auto loaded = surface::load_mesh(file, mesh_options);
  if (!loaded) throw Failure(Exit::input, loaded.error());
  for (const std::string& note : loaded->notes) session.console.warning("mesh", note);

  // Its points in the file's axes, and their box.
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const std::vector<float>& from = loaded->mesh->positions;
  for (std::size_t i = 0; i + 2 < from.size(); i += 3)
    points.push_back(options.z_up ? std::array{from[i], -from[i + 2], from[i + 1]}
                                  : std::array{from[i], from[i + 1], from[i + 2]});
  const std::vector<std::uint32_t>& corners = loaded->mesh->triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
    triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  std::array<double, 3> low, high;
  low.fill(1e30), high.fill(-1e30);
  for (const auto& point : points)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], double{point[a]});
      high[a] = std::max(high[a], double{point[a]});
    }
  const double longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  if (!(longest > 0)) throw Failure(Exit::input, fmt::format("{} has no size", file));
  const double voxel = longest / std::max(options.size.longest, 1);

  // Inside and outside: by themselves, or by a vote where there are holes.
  const volume::MeshView mesh{points, triangles};
  const std::int64_t open = volume::open_edges(mesh);
  std::optional<volume::InsideVote> vote;
  std::array<int, 3> size{};
  const int margin = 2;
  std::array<double, 3> start{};
  for (std::size_t a = 0; a < 3; ++a) {
    start[a] = low[a] - margin * voxel;
    size[a] = static_cast<int>(std::ceil((high[a] - low[a]) / voxel)) + 2 * margin + 1;
  }
  if (open > 0) {
    session.console.note(fmt::format(
        "{} is not closed ({} open edges): what most lines of sight find enclosed counts as inside",
        file, open));
    vote.emplace(mesh, start, voxel, size);
  }

  // Distances.
  RunStatus status;
  const SignalWatch watch(signals, status);
  volume::GridSpec spec;
  spec.name = "distance";
  spec.kind = volume::GridKind::level_set;
  spec.half = options.half;
  spec.background = options.band * static_cast<float>(voxel);
  const auto writer = (*vdb)->writer({spec}, {start, {voxel, voxel, voxel}});
  std::function<bool(int, int, int)> inside;
  if (vote) inside = [&](int i, int j, int k) { return vote->inside(i, j, k); };
  const auto made = (*vdb)->add_mesh(*writer, mesh, options.band, inside,
                                     [&] { return !status.cancel.load(); });
  if (const int signal = signals.stop_signal()) return static_cast<Exit>(128 + signal);
  if (!made) throw Failure(Exit::running, made.error().message);

  // The file.
  Hasher hasher;
  hasher.add(version);
  hasher.add(file_identity(file));
  hasher.add(fmt::format("{} {} {} {} {}", voxel, options.band, options.fit, options.z_up,
                         options.half));
  write_grids(*writer, common.outputs.front().file,
              {{"pse/version", std::string(version)},
               {"pse/inputs", file + "\n"},
               {"pse/up", options.z_up ? "z" : "y"}},
              hasher.finish().text(), common.provenance);
  session.console.note(fmt::format("wrote {}: {} triangles, voxels of {:.4g}, band {:.4g}",
                                   common.outputs.front().file, triangles.size(), voxel,
                                   double(spec.background)));
  return Exit::ok;
}

}  // namespace pse::app
