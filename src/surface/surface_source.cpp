// From hits to names.
#include "surface/surface_source.h"

#include <algorithm>
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
      const auto one_of = [&](std::initializer_list<What> list) {
        return std::find(list.begin(), list.end(), wanted->what) != list.end();
      };
      using enum What;
      if (one_of({uv})) wants_uv_ = true;
      if (one_of({pixelsize, pixel_freq, dpdx, dpdy})) wants_shifts_ = true;
      if (!one_of({id, depth, hit, view, origin, direction, axis_x, axis_y, axis_z}))
        wants_spots_ = true;
    }
  }
}

// How the place on the surface moves when the place in the picture moves by one pixel along `axis`:
// the step across the ray, carried along the ray onto the tangent plane.
Vec3 NameWriter::world_shift(const Shown& s, const Vec3& axis) {
  const Vec3& d = s.ray->direction;
  const Vec3 step = s.sighting->width * normalized(axis - dot(axis, d) * d);
  const double facing = std::min(dot(s.spot->flat, d), -0.001);
  return step - (dot(s.spot->flat, step) / facing) * d;
}

namespace {

// Two numbers and two vectors side by side: what every processor does at once.
using Pair [[gnu::vector_size(16)]] = double;
struct Vec3s {
  Pair x, y, z;
};
Vec3s operator-(const Vec3s& a, const Vec3s& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3s operator*(Pair s, const Vec3s& a) { return {s * a.x, s * a.y, s * a.z}; }
Pair dot(const Vec3s& a, const Vec3s& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3s both(const Vec3& a, const Vec3& b) {
  return {Pair{a.x, b.x}, Pair{a.y, b.y}, Pair{a.z, b.z}};
}

}  // namespace

// The same of many, with the same bits, in their objects' frames.
void NameWriter::set_shifts(std::span<Shown> shown) const {
  for (std::size_t k = 0; k < shown.size(); k += 2) {
    Shown &one = shown[k], &other = shown[std::min(k + 1, shown.size() - 1)];
    const Vec3s d = both(one.ray->direction, other.ray->direction),
                flat = both(one.spot->flat, other.spot->flat);
    const Pair width{one.sighting->width, other.sighting->width}, zero{};
    const Pair slope = dot(flat, d), facing = slope < -0.001 ? slope : zero - 0.001;
    for (Vec3 Shown::*shift : {&Shown::dx, &Shown::dy}) {
      const Vec3& axis = shift == &Shown::dx ? right_ : up_;
      const Vec3s along = both(axis, axis), across = along - dot(along, d) * d;
      const Pair square = dot(across, across);
      const Pair size{std::sqrt(square[0]), std::sqrt(square[1])};
      const Vec3s step = width * ((size > 0 ? 1 / size : zero + 1) * across);
      const Vec3s moved = step - (dot(flat, step) / facing) * d;
      const auto put = [&](Shown& s, const Vec3& v) {
        if (s.object >= 0)
          s.*shift = scene_->vector_to_object(static_cast<std::size_t>(s.object), v);
      };
      put(one, {moved.x[0], moved.y[0], moved.z[0]});
      put(other, {moved.x[1], moved.y[1], moved.z[1]});
    }
  }
}

void NameWriter::write_one(const Wanted& wanted, std::span<const Shown> shown,
                           const Outs& outs) const {
  const auto all = [&](const auto& value) {
    const bool complete = outs[0] != nullptr && outs[1] != nullptr && outs[2] != nullptr;
    for (const Shown& s : shown) {
      const Vec3& v = value(s);
      const std::uint32_t i = s.sighting->sample;
      if (complete || outs[0] != nullptr) outs[0][i] = static_cast<float>(v.x);
      if (complete || outs[1] != nullptr) outs[1][i] = static_cast<float>(v.y);
      if (complete || outs[2] != nullptr) outs[2][i] = static_cast<float>(v.z);
    }
  };
  const auto one = [&](const auto& value) {
    for (const Shown& s : shown) outs[0][s.sighting->sample] = static_cast<float>(value(s));
  };
  const auto axes = [&](int which) {
    all([&](const Shown& s) {
      const Vec3 unit{which == 0 ? 1.0 : 0, which == 1 ? 1.0 : 0, which == 2 ? 1.0 : 0};
      if (s.object < 0) return unit;
      return axis(scene_->object(static_cast<std::size_t>(s.object)).to_world, which);
    });
  };
  // From the place as it is stored, so that a G-buffer gives the same.
  const auto lit = [&](LightPart part) {
    const Light& light = scene_->lights()[wanted.light];
    const bool same = !light.is_lamp && part != LightPart::position;
    const Vec3 everywhere = light_value(light, part, {});
    all([&](const Shown& s) {
      return same ? everywhere : light_value(light, part, rounded(s.spot->place));
    });
  };
  // The side of a square as large as the pixel's image on the surface.
  const auto size = [](const Shown& s) {
    return s.object < 0 ? s.sighting->width : std::sqrt(length(cross(s.dx, s.dy)));
  };
  switch (wanted.what) {
    case What::point: return all([](const Shown& s) { return s.spot->point; });
    case What::place: return all([](const Shown& s) { return s.spot->place; });
    case What::normal: return all([](const Shown& s) { return s.spot->normal; });
    case What::flat_normal: return all([](const Shown& s) { return s.spot->flat; });
    case What::uv: return all([](const Shown& s) { return Vec3{s.spot->u, s.spot->v, 0}; });
    case What::id: return one([](const Shown& s) { return s.object + 1.0; });
    case What::depth:
      return one([](const Shown& s) { return s.object < 0 ? far_away : s.sighting->depth; });
    case What::hit: return one([](const Shown& s) { return s.object < 0 ? 0.0 : 1.0; });
    case What::backface: return one([](const Shown& s) { return s.spot->back ? 1.0 : 0.0; });
    case What::view: return all([](const Shown& s) { return -s.ray->direction; });
    case What::origin: return all([](const Shown& s) { return s.ray->origin; });
    case What::direction: return all([](const Shown& s) { return s.ray->direction; });
    case What::pixelsize: return one(size);
    case What::pixel_freq:
      return one([&](const Shown& s) { return 0.5 / static_cast<float>(size(s)); });
    case What::dpdx: return all([](const Shown& s) { return s.dx; });
    case What::dpdy: return all([](const Shown& s) { return -s.dy; });
    case What::place_dx:
      return all([&](const Shown& s) { return s.object < 0 ? Vec3{} : world_shift(s, right_); });
    case What::place_dy:
      return all([&](const Shown& s) { return s.object < 0 ? Vec3{} : -world_shift(s, up_); });
    case What::axis_x: return axes(0);
    case What::axis_y: return axes(1);
    case What::axis_z: return axes(2);
    case What::light_direction: return lit(LightPart::direction);
    case What::light_color: return lit(LightPart::color);
    case What::light_position: return lit(LightPart::position);
    case What::light_radius: return lit(LightPart::radius);
  }
}

void NameWriter::begin(std::size_t count, std::span<float* const> planes) const {
  for (const Wanted& wanted : wanted_)
    if (wanted.what == What::id && planes[wanted.input] != nullptr)
      std::fill_n(planes[wanted.input], count, 0.0f);
}

void NameWriter::write(std::span<const Sighting> sightings, std::span<const Ray> rays,
                       std::span<const Hit> hits, std::span<float* const> planes) const {
  // What objects look like; the background looks like nothing.
  thread_local std::vector<Shown> shown;
  thread_local std::vector<Ray> object_rays;
  thread_local std::vector<Hit> object_hits;
  thread_local std::vector<Spot> spots;
  spots.resize(hits.size());
  if (wants_spots_ && std::ranges::all_of(hits, &Hit::found)) {
    scene_->describe(rays, hits, wants_uv_, spots);
  } else if (wants_spots_) {
    object_rays.clear(), object_hits.clear();
    for (std::size_t k = 0; k < hits.size(); ++k)
      if (hits[k].found()) object_rays.push_back(rays[k]), object_hits.push_back(hits[k]);
    scene_->describe(object_rays, object_hits, wants_uv_, spots);
  }
  static const Spot nothing;
  const Spot* next = spots.data();
  shown.resize(hits.size());
  for (std::size_t k = 0; k < hits.size(); ++k)
    shown[k] = {&sightings[k], &rays[k], hits[k].found() ? next++ : &nothing, hits[k].object, {}, {}};
  if (wants_shifts_) set_shifts(shown);

  // The components of a vector stand side by side and are computed once.
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const Wanted& wanted = wanted_[k];
    Outs outs{};
    outs[static_cast<std::size_t>(wanted.component)] = planes[wanted.input];
    while (k + 1 < wanted_.size() && wanted_[k + 1].what == wanted.what &&
           wanted_[k + 1].light == wanted.light &&
           outs[static_cast<std::size_t>(wanted_[k + 1].component)] == nullptr) {
      ++k;
      outs[static_cast<std::size_t>(wanted_[k].component)] = planes[wanted_[k].input];
    }
    if (outs != Outs{}) write_one(wanted, shown, outs);
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
    : scene_(scene),
      lens_(lens),
      cover_(*scene, lens),
      names_(module, std::move(scene), lens),
      misses_(misses) {}

namespace {

// The order in which rays are sent: where samples are rows of a picture, in blocks of 4 by 2 pixels,
// so that eight rays in a row lie side by side. (What a sample shows does not depend on it.) The
// last one made is kept, since most tiles have the same.
class Order {
 public:
  std::span<const std::uint32_t> of(std::span<const double> y) {
    std::size_t row = 1;
    while (row < y.size() && y[row] == y[0]) ++row;
    if (row != row_ || y.size() != order_.size()) make(row, y.size());
    return order_;
  }

 private:
  void make(std::size_t row, std::size_t count) {
    row_ = row;
    order_.clear();
    const std::size_t rows = count / row;
    const auto add = [&](std::size_t i) { order_.push_back(static_cast<std::uint32_t>(i)); };
    if (row < 8 || row * rows != count) {
      for (std::size_t i = 0; i < count; ++i) add(i);
      return;
    }
    for (std::size_t top = 0; top < rows; top += 2)
      for (std::size_t left = 0; left < row; left += 4)
        for (std::size_t down = top; down < std::min(top + 2, rows); ++down)
          for (std::size_t across = left; across < std::min(left + 4, row); ++across)
            add(down * row + across);
  }

  std::size_t row_ = 0;
  std::vector<std::uint32_t> order_;
};

}  // namespace

// A piece at a time, so that rays and hits stay in the cache.
void SurfaceSource::fill(std::span<const double> x, std::span<const double> y,
                         std::span<float* const> planes) const {
  constexpr std::size_t piece = 256;
  thread_local Order order;
  thread_local std::vector<std::uint32_t> near, empty;
  near.resize(x.size()), empty.resize(x.size());
  std::size_t nears = 0, empties = 0;
  for (const std::uint32_t i : order.of(y)) {
    near[nears] = empty[empties] = i;
    ++(cover_.may_show(x[i], y[i]) ? nears : empties);
  }
  near.resize(nears), empty.resize(empties);
  names_.begin(x.size(), planes);
  const auto in_pieces = [&](const std::vector<std::uint32_t>& samples, bool are_empty) {
    for (std::size_t i = 0; i < samples.size(); i += piece)
      fill_some(x, y, std::span(samples).subspan(i, std::min(piece, samples.size() - i)), are_empty,
                planes);
  };
  in_pieces(near, false);
  if (misses_) in_pieces(empty, true);
}

void SurfaceSource::fill_some(std::span<const double> x, std::span<const double> y,
                              std::span<const std::uint32_t> samples, bool empty,
                              std::span<float* const> planes) const {
  thread_local std::vector<Ray> rays;
  thread_local std::vector<Hit> hits;
  thread_local std::vector<Sighting> sightings;
  rays.resize(samples.size()), hits.assign(samples.size(), {});
  lens_.rays(x, y, samples, rays);
  if (!empty) scene_->trace(rays, hits);
  // What is shown, moved together.
  sightings.resize(samples.size());
  std::size_t count = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (!hits[k].found() && !misses_) continue;
    const double t = hits[k].found() ? hits[k].t() : 1;
    sightings[count] = {samples[k], lens_.width(rays[k], t), lens_.depth(rays[k], t)};
    hits[count] = hits[k], rays[count] = rays[k];
    ++count;
  }
  names_.write(std::span(sightings).first(count), std::span(rays).first(count),
               std::span(hits).first(count), planes);
}

TileSource at_pixel_centres(std::shared_ptr<const SampleSource> source, double sample_x,
                            double sample_y) {
  return [source = std::move(source), sample_x, sample_y](const TileView& tile) {
    thread_local std::vector<double> x, y;
    x.resize(static_cast<std::size_t>(tile.count)), y.resize(x.size());
    auto next_x = x.begin(), next_y = y.begin();
    for (int row = tile.rect.y0; row < tile.rect.y1; ++row) {
      for (int column = tile.rect.x0; column < tile.rect.x1; ++column)
        *next_x++ = column + sample_x;
      next_y = std::fill_n(next_y, tile.rect.width(), row + sample_y);
    }
    source->fill(x, y, tile.planes);
  };
}

}  // namespace pse::surface
