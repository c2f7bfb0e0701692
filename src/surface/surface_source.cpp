// From hits to names.
#include "surface/surface_source.h"

#include <array>
#include <string_view>

namespace pse::surface {
namespace {

constexpr double far_away = 1e10;  // depth where nothing is, as other renderers write it

Vec3 rounded(const Vec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Vec3 axis(const Affine& map, int which) {
  return normalized(which == 0 ? map.x : which == 1 ? map.y : map.z);
}

std::string light_name(std::size_t light, const char* what) {
  return "light" + (light == 0 ? "" : std::to_string(light + 1)) + "_" + what;
}

}  // namespace

std::vector<StreamName> surface_names(std::size_t lights) {
  using enum ir::Rate;
  std::vector<StreamName> names = {
      {"point", 3, sample, ir::InputSlopes::of_sample},
      {"place", 3, sample, ir::InputSlopes::of_sample},
      {"normal", 3, sample},
      {"flat_normal", 3, sample}, {"uv", 2, sample},       {"u", 1, sample},
      {"v", 1, sample},          {"id", 1, sample},        {"depth", 1, sample},
      {"hit", 1, sample},        {"backface", 1, sample},  {"view", 3, sample},
      {"origin", 3, sample},     {"direction", 3, sample}, {"pixelsize", 1, sample},
      {"pixel_freq", 1, sample}, {"dPdx", 3, sample},      {"dPdy", 3, sample},
      {"axis_x", 3, sample},     {"axis_y", 3, sample},    {"axis_z", 3, sample},
      {"eye", 3, frame},         {"light_count", 1, frame}};
  for (std::size_t i = 0; i < lights; ++i) {
    names.push_back({light_name(i, "direction"), 3, sample});
    names.push_back({light_name(i, "color"), 3, sample});
    names.push_back({light_name(i, "position"), 3, sample});
    names.push_back({light_name(i, "radius"), 1, sample});
  }
  return names;
}

std::optional<NameWriter::Wanted> NameWriter::find(const std::string& name, std::size_t lights) {
  using enum What;
  const std::size_t dot = name.find('.');
  const std::string base = name.substr(0, dot);
  const int component = dot == std::string::npos ? 0 : name[dot + 1] - '0';
  if (name.size() > dot + 2 && name[dot + 2] == '$') {
    const bool along_x = name.back() == 'x';
    if (base == "point") return Wanted{0, along_x ? dpdx : dpdy, component, 0};
    if (base == "place") return Wanted{0, along_x ? place_dx : place_dy, component, 0};
    return {};
  }
  constexpr std::array<std::pair<std::string_view, What>, 19> plain = {
      {{"point", point},         {"place", place},       {"normal", normal},
       {"flat_normal", flat_normal}, {"uv", uv},         {"id", id},
       {"depth", depth},         {"hit", hit},           {"backface", backface},
       {"view", view},           {"origin", origin},     {"direction", direction},
       {"pixelsize", pixelsize}, {"pixel_freq", pixel_freq}, {"dPdx", dpdx},
       {"dPdy", dpdy},           {"axis_x", axis_x},     {"axis_y", axis_y},
       {"axis_z", axis_z}}};
  for (const auto& [text, what] : plain)
    if (base == text) return Wanted{0, what, component, 0};
  if (base == "u") return Wanted{0, uv, 0, 0};
  if (base == "v") return Wanted{0, uv, 1, 0};
  for (std::size_t i = 0; i < lights; ++i)
    for (const auto& [text, what] :
         {std::pair{"direction", light_direction}, {"color", light_color},
          {"position", light_position}, {"radius", light_radius}})
      if (base == light_name(i, text)) return Wanted{0, what, component, i};
  return {};
}

NameWriter::NameWriter(const ir::Module& module, std::shared_ptr<const Scene> scene,
                       const Lens& lens)
    : scene_(std::move(scene)), right_(lens.right()), up_(lens.up()) {
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate != ir::Rate::sample) continue;
    if (auto wanted = find(module.inputs[i].name, scene_->lights().size())) {
      wanted->input = i;
      wanted_.push_back(*wanted);
    }
  }
}

// How the place on the surface moves when the place in the picture moves by one pixel along `axis`:
// the step across the ray, carried along the ray onto the tangent plane.
Vec3 NameWriter::world_shift(const Sighting& s, const Vec3& axis) {
  const Vec3& d = s.ray.direction;
  const Vec3 step = s.width * normalized(axis - dot(axis, d) * d);
  const double facing = std::min(dot(s.hit.flat, d), -0.001);
  return step - (dot(s.hit.flat, step) / facing) * d;
}

// The same in the object's frame.
Vec3 NameWriter::shift(const Sighting& s, const Vec3& axis) const {
  return scene_->to_object(static_cast<std::size_t>(s.hit.object)).vector(world_shift(s, axis));
}

Vec3 NameWriter::value(const Sighting& s, const Wanted& wanted) const {
  const Hit& h = s.hit;
  const bool seen = h.found();
  const Affine* map =
      seen ? &scene_->object(static_cast<std::size_t>(h.object)).to_world : nullptr;
  const auto lit = [&]() -> const Light& { return scene_->lights()[wanted.light]; };
  switch (wanted.what) {
    case What::point: return h.point;
    case What::place: return h.place;
    case What::normal: return h.normal;
    case What::flat_normal: return h.flat;
    case What::uv: return {h.u, h.v, 0};
    case What::id: return {seen ? h.object + 1.0 : 0, 0, 0};
    case What::depth: return {seen ? s.depth : far_away, 0, 0};
    case What::hit: return {seen ? 1.0 : 0, 0, 0};
    case What::backface: return {h.back ? 1.0 : 0, 0, 0};
    case What::view: return -s.ray.direction;
    case What::origin: return s.ray.origin;
    case What::direction: return s.ray.direction;
    case What::pixelsize:
    case What::pixel_freq: {
      // The side of a square as large as the pixel's image on the surface.
      double size = s.width;
      if (seen) size = std::sqrt(length(cross(shift(s, right_), shift(s, up_))));
      return {wanted.what == What::pixelsize ? size : 0.5 / static_cast<float>(size), 0, 0};
    }
    case What::dpdx: return seen ? shift(s, right_) : Vec3{};
    case What::dpdy: return seen ? -shift(s, up_) : Vec3{};
    case What::place_dx: return seen ? world_shift(s, right_) : Vec3{};
    case What::place_dy: return seen ? -world_shift(s, up_) : Vec3{};
    case What::axis_x: return seen ? axis(*map, 0) : Vec3{1, 0, 0};
    case What::axis_y: return seen ? axis(*map, 1) : Vec3{0, 1, 0};
    case What::axis_z: return seen ? axis(*map, 2) : Vec3{0, 0, 1};
    // From the place as it is stored, so that a G-buffer gives the same.
    case What::light_direction: return light_value(lit(), LightPart::direction, rounded(h.place));
    case What::light_color: return light_value(lit(), LightPart::color, rounded(h.place));
    case What::light_position: return light_value(lit(), LightPart::position, rounded(h.place));
    case What::light_radius: return light_value(lit(), LightPart::radius, rounded(h.place));
  }
  return {};
}

void NameWriter::write(std::span<const Sighting> sightings, std::span<float* const> planes,
                       bool misses) const {
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const Wanted& wanted = wanted_[k];
    float* out = planes[wanted.input];
    if (out == nullptr) continue;
    // The components of a vector stand side by side and are computed once.
    std::array<float*, 3> outs{};
    std::size_t last = k;
    outs[static_cast<std::size_t>(wanted.component)] = out;
    while (last + 1 < wanted_.size() && wanted_[last + 1].what == wanted.what &&
           wanted_[last + 1].light == wanted.light &&
           outs[static_cast<std::size_t>(wanted_[last + 1].component)] == nullptr) {
      ++last;
      outs[static_cast<std::size_t>(wanted_[last].component)] = planes[wanted_[last].input];
    }
    const bool all = misses || wanted.what == What::id;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      if (!all && !sightings[i].hit.found()) continue;
      const Vec3 v = value(sightings[i], wanted);
      if (outs[0] != nullptr) outs[0][i] = static_cast<float>(v.x);
      if (outs[1] != nullptr) outs[1][i] = static_cast<float>(v.y);
      if (outs[2] != nullptr) outs[2][i] = static_cast<float>(v.z);
    }
    k = last;
  }
}

void set_scene_uniforms(const ir::Module& module, std::span<const Light> lights, const Vec3& eye,
                        FrameState& state) {
  state.uniforms.resize(module.inputs.size());
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    const ir::Input& input = module.inputs[i];
    if (input.rate == ir::Rate::sample) continue;
    if (input.name == "light_count")
      state.uniforms[i] = static_cast<float>(lights.size());
    if (input.name.starts_with("eye.") && input.name.size() == 5)
      state.uniforms[i] = static_cast<float>(eye[input.name[4] - '0']);
  }
}

SurfaceSource::SurfaceSource(const ir::Module& module, std::shared_ptr<const Scene> scene,
                             const Lens& lens, bool misses)
    : scene_(scene), lens_(lens), names_(module, std::move(scene), lens), misses_(misses) {}

// A piece at a time, so that rays and hits stay in the cache.
void SurfaceSource::fill(std::span<const double> x, std::span<const double> y,
                         std::span<float* const> planes) const {
  constexpr std::size_t piece = 512;
  std::vector<float*> moved(planes.begin(), planes.end());
  for (std::size_t i = 0; i < x.size(); i += piece) {
    const std::size_t count = std::min(piece, x.size() - i);
    for (std::size_t k = 0; k < moved.size(); ++k)
      moved[k] = planes[k] == nullptr ? nullptr : planes[k] + i;
    fill_some(x.subspan(i, count), y.subspan(i, count), moved);
  }
}

void SurfaceSource::fill_some(std::span<const double> x, std::span<const double> y,
                              std::span<float* const> planes) const {
  thread_local std::vector<Ray> rays;
  thread_local std::vector<Hit> hits;
  thread_local std::vector<Sighting> sightings;
  rays.resize(x.size()), hits.resize(x.size()), sightings.clear();
  for (std::size_t i = 0; i < x.size(); ++i) rays[i] = lens_.ray(x[i], y[i]);
  scene_->trace(rays, hits);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = hits[i].found() ? hits[i].t : 1;
    sightings.push_back({rays[i], hits[i], lens_.width(rays[i], t), lens_.depth(rays[i], t)});
  }
  names_.write(sightings, planes, misses_);
}

TileSource at_pixel_centres(std::shared_ptr<const SampleSource> source, double sample_x,
                            double sample_y) {
  return [source = std::move(source), sample_x, sample_y](const TileView& tile) {
    std::vector<double> x, y;
    x.reserve(static_cast<std::size_t>(tile.count)), y.reserve(static_cast<std::size_t>(tile.count));
    for (int row = tile.rect.y0; row < tile.rect.y1; ++row)
      for (int column = tile.rect.x0; column < tile.rect.x1; ++column)
        x.push_back(column + sample_x), y.push_back(row + sample_y);
    source->fill(x, y, tile.planes);
  };
}

}  // namespace pse::surface
