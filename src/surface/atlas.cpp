// Laying the triangles out, naming what samples show, and from samples to texels. See the header.
#include "surface/atlas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

namespace pse::surface {
namespace {

struct Point {
  double x = 0, y = 0;
};
double cross(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

std::array<std::uint32_t, 3> corners(const Mesh& mesh, std::size_t triangle) {
  return {mesh.triangles[3 * triangle], mesh.triangles[3 * triangle + 1],
          mesh.triangles[3 * triangle + 2]};
}
Point uv_of(const Mesh& mesh, std::uint32_t vertex) {
  return {mesh.uvs[2 * std::size_t{vertex}], mesh.uvs[2 * std::size_t{vertex} + 1]};
}
Vec3 normal_of(const Mesh& mesh, std::uint32_t vertex) {
  const float* n = &mesh.normals[3 * std::size_t{vertex}];
  return {n[0], n[1], n[2]};
}

// The weights of the point of a triangle nearest to p, and its squared distance; 0 inside.
struct Nearest {
  double b = 0, c = 0, distance = 0;
  bool within = false;  // clearly inside, away from the edges
  bool touches = true;  // the square of side 1 around p reaches that point
};

Nearest nearest_point(const std::array<Point, 3>& t, double area, const Point& p) {
  Nearest best;
  best.b = cross(t[0], p, t[2]) / area;
  best.c = cross(t[0], t[1], p) / area;
  const double a = 1 - best.b - best.c;
  constexpr double rim = 1e-5;
  best.within = a > rim && best.b > rim && best.c > rim;
  if (a >= 0 && best.b >= 0 && best.c >= 0) return best;
  // Outside: the nearest place of the three edges.
  best.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Point &from = t[i], &to = t[(i + 1) % 3];
    const Point edge{to.x - from.x, to.y - from.y};
    const double s = std::clamp(
        ((p.x - from.x) * edge.x + (p.y - from.y) * edge.y) / (edge.x * edge.x + edge.y * edge.y),
        0.0, 1.0);
    const double dx = from.x + s * edge.x - p.x, dy = from.y + s * edge.y - p.y;
    if (dx * dx + dy * dy >= best.distance) continue;
    best.distance = dx * dx + dy * dy;
    best.touches = std::max(std::fabs(dx), std::fabs(dy)) < 0.4999;
    best.b = i == 0 ? s : i == 1 ? 1 - s : 0;
    best.c = i == 1 ? s : i == 2 ? 1 - s : 0;
  }
  return best;
}

// How much of the mesh's area in texture coordinates lies in each unit square, as UDIM numbers; 0
// for squares without one. A triangle belongs where its middle is.
std::map<int, double> tiles_of(const Mesh& mesh) {
  std::map<int, double> tiles;
  double whole = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto v = corners(mesh, t);
    const Point a = uv_of(mesh, v[0]), b = uv_of(mesh, v[1]), c = uv_of(mesh, v[2]);
    const double u = std::floor((a.x + b.x + c.x) / 3), w = std::floor((a.y + b.y + c.y) / 3);
    const bool named = u >= 0 && u < 10 && w >= 0 && w < 900;
    const double area = std::fabs(cross(a, b, c));
    tiles[named ? 1001 + static_cast<int>(u) + 10 * static_cast<int>(w) : 0] += area;
    whole += area;
  }
  for (auto& [tile, area] : tiles) area /= whole;
  return tiles;
}

std::string what_is_wrong(const Mesh& mesh, int tile) {
  if (mesh.uvs.empty())
    return "the mesh has no texture coordinates (UVs), so it has no atlas; unwrap it in a "
           "modelling program first";
  for (const float value : mesh.uvs)
    if (!(std::fabs(value) < 1000))
      return "the mesh's texture coordinates go beyond 1000, so they repeat a texture and are no "
             "atlas";
  const std::map<int, double> tiles = tiles_of(mesh);
  std::string list;
  bool several = false;
  for (const auto& [number, part] : tiles) {
    constexpr double much = 0.1;
    if (number == 0) continue;
    list += (list.empty() ? "" : ", ") + std::to_string(number);
    several = several || (number != 1001 && part > much);
  }
  if (tile != 0 && !tiles.contains(tile))
    return "the mesh has nothing in tile " + std::to_string(tile) + "; it has " + list;
  if (tile == 0 && several)
    return (tiles.contains(1001) || list.find(',') != std::string::npos
                ? "the mesh's texture coordinates fill several tiles ("
                : "the mesh's texture coordinates lie in another tile than 1001 (") + list +
           "); bake each with --udim and its number";
  return "";
}

}  // namespace

std::expected<Atlas, std::string> make_atlas(const Mesh& mesh, const AtlasSize& size) {
  if (const std::string wrong = what_is_wrong(mesh, size.tile); !wrong.empty())
    return std::unexpected(wrong);
  Atlas atlas{size, {}, 0};
  const int columns = atlas.columns(), rows = atlas.rows();
  // Without a tile everything lies in one square, which repeats; else a tile is a square of its
  // own.
  const int tile = size.tile == 0 ? 0 : size.tile - 1001;
  const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  constexpr std::uint32_t none = 0xffffffff;
  struct Shown {
    std::uint32_t triangle = none;
    float b = 0, c = 0, distance = 0;
  };
  std::vector<Shown> grid(count);
  std::vector<bool> overlapped(count);
  // Lays triangle t, moved by whole squares, over the grid.
  const auto lay = [&](std::size_t t, double left, double bottom) {
    // The triangle in units of samples, y downward.
    std::array<Point, 3> p;
    const auto vertices = corners(mesh, t);
    for (std::size_t i = 0; i < 3; ++i) {
      const Point uv = uv_of(mesh, vertices[i]);
      p[i] = {(uv.x - left) * columns, (1 - (uv.y - bottom)) * rows};
    }
    const double area = cross(p[0], p[1], p[2]);
    if (!(std::fabs(area) > 1e-12)) return;
    const auto [x_least, x_most] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [y_least, y_most] = std::minmax({p[0].y, p[1].y, p[2].y});
    const auto cut = [](double value, int most) {
      return static_cast<int>(std::clamp(value, 0.0, double(most)));
    };
    const int x0 = cut(std::floor(x_least - 1), columns), x1 = cut(std::ceil(x_most + 1), columns);
    const int y0 = cut(std::floor(y_least - 1), rows), y1 = cut(std::ceil(y_most + 1), rows);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const Nearest near = nearest_point(p, area, {x + 0.5, y + 0.5});
        if (!near.touches) continue;
        const auto place = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                           static_cast<std::size_t>(x);
        Shown& shown = grid[place];
        const bool taken = shown.triangle != none && shown.distance == 0;
        if (taken && near.within) overlapped[place] = true;
        if (taken || (shown.triangle != none && shown.distance <= near.distance)) continue;
        shown = {static_cast<std::uint32_t>(t), static_cast<float>(near.b),
                 static_cast<float>(near.c), static_cast<float>(near.distance)};
      }
    }
  };
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (size.tile != 0) {
      lay(t, tile % 10, std::floor(tile / 10));
      continue;
    }
    const auto v = corners(mesh, t);
    const Point a = uv_of(mesh, v[0]), b = uv_of(mesh, v[1]), c = uv_of(mesh, v[2]);
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [bottom, top] = std::minmax({a.y, b.y, c.y});
    for (double w = std::floor(bottom); w <= std::floor(top); ++w)
      for (double u = std::floor(left); u <= std::floor(right); ++u) lay(t, u, w);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (grid[i].triangle == none) continue;
    atlas.samples.push_back(
        {static_cast<std::uint32_t>(i), grid[i].triangle, grid[i].b, grid[i].c});
    atlas.overlaps += overlapped[i] ? 1 : 0;
  }
  if (atlas.samples.empty())
    return std::unexpected("the mesh's texture coordinates cover no texel");
  return atlas;
}

std::vector<StreamName> atlas_names() {
  using enum ir::Rate;
  constexpr auto sloping = ir::InputSlopes::of_sample;
  return {{"point", 3, sample, sloping}, {"place", 3, sample, sloping}, {"normal", 3, sample},
          {"flat_normal", 3, sample}, {"view", 3, sample},      {"uv", 2, sample},
          {"u", 1, sample},           {"v", 1, sample},         {"id", 1, sample},
          {"hit", 1, sample},         {"backface", 1, sample},  {"px", 1, sample},
          {"py", 1, sample},          {"pixelsize", 1, sample}, {"pixel_freq", 1, sample}};
}

TileSource atlas_source(const ir::Module& module, const Mesh& mesh, const Atlas& atlas, int row) {
  struct Wanted {
    std::size_t input;
    std::string name;
    int component;
  };
  std::vector<Wanted> wanted;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    const std::string& name = module.inputs[i].name;
    if (module.inputs[i].rate != ir::Rate::sample) continue;
    const std::size_t dot = name.find('.');
    const std::size_t slope = std::min(name.find('$'), name.size());
    wanted.push_back({i, name.substr(0, dot) + name.substr(slope),
                      dot == std::string::npos ? 0 : name[dot + 1] - '0'});
  }
  const auto value = [&mesh, &atlas](const AtlasSample& s, const std::string& name) -> Vec3 {
    const auto v = corners(mesh, s.triangle);
    const double b = s.b, c = s.c, a = 1 - b - c;
    const Vec3 p0 = mesh.position(v[0]), p1 = mesh.position(v[1]), p2 = mesh.position(v[2]);
    if (name == "point" || name == "place") return a * p0 + b * p1 + c * p2;
    if (name == "normal" || name == "view") {
      const Vec3 n =
          a * normal_of(mesh, v[0]) + b * normal_of(mesh, v[1]) + c * normal_of(mesh, v[2]);
      return normalized(n);
    }
    const Vec3 flat = surface::cross(p1 - p0, p2 - p0);
    if (name == "flat_normal") return normalized(flat);
    const Point t0 = uv_of(mesh, v[0]), t1 = uv_of(mesh, v[1]), t2 = uv_of(mesh, v[2]);
    if (name == "uv" || name == "u" || name == "v") {
      const Vec3 uv{a * t0.x + b * t1.x + c * t2.x, a * t0.y + b * t1.y + c * t2.y, 0};
      return name == "v" ? Vec3{uv.y, 0, 0} : uv;
    }
    if (name.starts_with("point$") || name.starts_with("place$")) {
      // Along one texel to the right, or one down.
      const Point s1{t1.x - t0.x, t1.y - t0.y}, s2{t2.x - t0.x, t2.y - t0.y};
      const double area = s1.x * s2.y - s1.y * s2.x;
      if (name.back() == 'x')
        return 1 / (area * atlas.size.width) * (s2.y * (p1 - p0) - s1.y * (p2 - p0));
      return -1 / (area * atlas.size.height) * (s1.x * (p2 - p0) - s2.x * (p1 - p0));
    }
    if (name == "id" || name == "hit") return {1, 0, 0};
    const auto columns = static_cast<std::uint32_t>(atlas.columns());
    if (name == "px") return {(s.place % columns + 0.5) / atlas.size.samples, 0, 0};
    if (name == "py") return {(std::floor(s.place / columns) + 0.5) / atlas.size.samples, 0, 0};
    if (name == "pixelsize" || name == "pixel_freq") {
      const double texels = std::fabs(cross(t0, t1, t2)) * atlas.size.width * atlas.size.height;
      const double size = std::sqrt(length(flat) / texels);
      return {name == "pixelsize" ? size : 0.5 / size, 0, 0};
    }
    return {};  // backface
  };
  return [wanted, value, &atlas, row](const TileView& tile) {
    for (const Wanted& want : wanted) {
      float* out = tile.planes[want.input];
      for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
        for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
          const auto i = static_cast<std::size_t>(std::int64_t{y} * row + x);
          const AtlasSample& s = atlas.samples[std::min(i, atlas.samples.size() - 1)];
          *out++ = static_cast<float>(value(s, want.name)[want.component]);
        }
    }
  };
}

std::vector<float> resolve(const Atlas& atlas, const std::vector<float>& values, int margin) {
  const int width = atlas.size.width, height = atlas.size.height, side = atlas.size.samples;
  const auto texels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<float> plane(texels);
  std::vector<std::uint16_t> count(texels);
  // The mean of each texel's samples.
  const auto columns = static_cast<std::uint32_t>(atlas.columns());
  for (std::size_t i = 0; i < atlas.samples.size(); ++i) {
    const std::uint32_t x = atlas.samples[i].place % columns, y = atlas.samples[i].place / columns;
    const auto texel =
        std::size_t{y / static_cast<std::uint32_t>(side)} * static_cast<std::size_t>(width) +
        x / static_cast<std::uint32_t>(side);
    plane[texel] += values[i];
    ++count[texel];
  }
  std::vector<std::uint32_t> open;
  for (std::size_t i = 0; i < texels; ++i) {
    if (count[i] > 0)
      plane[i] /= count[i];
    else
      open.push_back(static_cast<std::uint32_t>(i));
  }
  // Beyond the edges, a ring of texels at a time.
  std::vector<std::uint32_t> left;
  std::vector<std::pair<std::uint32_t, float>> ring;
  for (int turn = 0; turn < margin && !open.empty(); ++turn) {
    left.clear(), ring.clear();
    for (const std::uint32_t i : open) {
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      float sum = 0;
      int around = 0;
      for (int yy = std::max(y - 1, 0); yy <= std::min(y + 1, height - 1); ++yy)
        for (int xx = std::max(x - 1, 0); xx <= std::min(x + 1, width - 1); ++xx) {
          const auto k = static_cast<std::size_t>(yy) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(xx);
          if (count[k] == 0) continue;
          sum += plane[k];
          ++around;
        }
      if (around > 0)
        ring.emplace_back(i, sum / static_cast<float>(around));
      else
        left.push_back(i);
    }
    for (const auto& [i, filled] : ring) plane[i] = filled, count[i] = 1;
    std::swap(open, left);
  }
  return plane;
}

}  // namespace pse::surface
