// From hits to names.
#include "surface/surface_source.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace pse::surface {
namespace {

constexpr double far_away = 1e10;  // depth where nothing is, as other renderers write it

Vec3 axis(const Affine& map, int which) {
  return normalized(which == 0 ? map.x : which == 1 ? map.y : map.z);
}

LightPart part_of(What light) {
  using enum What;
  return light == light_direction  ? LightPart::direction
         : light == light_color    ? LightPart::color
         : light == light_position ? LightPart::position
                                   : LightPart::radius;
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
      if (one_of({pixelsize, pixel_freq, dpdx, dpdy, place_dx, place_dy})) wants_shifts_ = true;
      if (!one_of({id, depth, hit, view, origin, direction, axis_x, axis_y, axis_z}))
        wants_spots_ = true;
    }
  }
}

// Whether it is another one at each place.
bool NameWriter::follows_place(const Wanted& wanted) const {
  using enum What;
  if (wanted.what < light_direction || wanted.what == light_radius) return false;
  return wanted.what == light_position || scene_->lights()[wanted.light].is_lamp;
}

// What all samples have that show an object, or the background (-1).
double NameWriter::number(const Wanted& wanted, int object) const {
  using enum What;
  const auto of_axis = [&](int which) {
    const Vec3 unit{which == 0 ? 1.0 : 0, which == 1 ? 1.0 : 0, which == 2 ? 1.0 : 0};
    if (object < 0) return unit[wanted.component];
    const Affine& map = scene_->object(static_cast<std::size_t>(object)).to_world;
    return axis(map, which)[wanted.component];
  };
  switch (wanted.what) {
    case id: return object + 1.0;
    case hit: return object < 0 ? 0 : 1;
    case axis_x: return of_axis(0);
    case axis_y: return of_axis(1);
    case axis_z: return of_axis(2);
    default:
      return light_value(scene_->lights()[wanted.light], part_of(wanted.what),
                         {})[wanted.component];
  }
}

void NameWriter::begin(std::size_t count, std::span<float* const> planes) const {
  for (const Wanted& wanted : wanted_)
    if (wanted.what == What::id && planes[wanted.input] != nullptr)
      std::fill_n(planes[wanted.input], count, 0.0f);
}

void NameWriter::write(std::span<const Sighting> sightings, std::span<const Ray> rays,
                       std::span<const Hit> hits, std::span<float* const> planes) const {
  for (std::size_t begin = 0, end = 0; begin < hits.size(); begin = end) {
    for (end = begin + 1; end < hits.size() && hits[end].object == hits[begin].object;) ++end;
    const std::size_t count = end - begin;
    write_run(sightings.subspan(begin, count), rays.subspan(begin, count),
              hits.subspan(begin, count), planes);
  }
}

void NameWriter::write_run(std::span<const Sighting> sightings, std::span<const Ray> rays,
                           std::span<const Hit> hits, std::span<float* const> planes) const {
  thread_local std::vector<ShapePoint> points;
  thread_local std::vector<NameStore> stores;
  thread_local std::array<std::vector<float>, 3> places;
  const int object = hits.front().object;
  NameValues values{.count = hits.size(), .sightings = sightings.data(), .rays = rays.data(),
                    .hits = hits.data(), .points = nullptr, .frame = {}, .right = right_,
                    .up = up_, .wants_shifts = wants_shifts_, .is_background = object < 0,
                    .stores = nullptr, .store_count = 0, .places = {}};
  if (object >= 0) values.frame = scene_->frame(static_cast<std::size_t>(object));
  if (object >= 0 && wants_spots_) {
    points.resize(hits.size());
    scene_->describe_own(rays, hits, wants_uv_, points);
    values.points = points.data();
  }

  // What goes where.
  stores.clear();
  bool wants_places = false;
  for (const Wanted& wanted : wanted_) {
    float* out = planes[wanted.input];
    if (out == nullptr) continue;
    if (follows_place(wanted)) {
      wants_places = true;
      continue;
    }
    const bool computed = wanted.what < What::id;
    NameStore store{out, wanted.what, wanted.component, 0};
    if (!computed) store.number = static_cast<float>(number(wanted, object));
    if (wanted.what == What::depth && object < 0)
      store.what = What::id, store.number = static_cast<float>(far_away);
    stores.push_back(store);
  }
  values.stores = stores.data(), values.store_count = stores.size();
  if (wants_places)
    for (std::size_t c = 0; c < 3; ++c)
      places[c].resize(hits.size()), values.places[c] = places[c].data();
  function_(values);
  if (!wants_places) return;

  // Lights, from the places as they are stored, so that a G-buffer gives the same.
  for (const Wanted& wanted : wanted_) {
    float* out = planes[wanted.input];
    if (out == nullptr || !follows_place(wanted)) continue;
    const LightPart part = part_of(wanted.what);
    const Light& light = scene_->lights()[wanted.light];
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const Vec3 place{places[0][k], places[1][k], places[2][k]};
      out[sightings[k].sample] =
          static_cast<float>(light_value(light, part, place)[wanted.component]);
    }
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

// The order in which rays are sent: where samples are rows of a picture, in blocks of 4 by 4
// pixels, so that eight or sixteen rays in a row lie side by side. (What a sample shows does not
// depend on it.) The last one made is kept, since most tiles have the same.
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
    for (std::size_t top = 0; top < rows; top += 4)
      for (std::size_t left = 0; left < row; left += 4)
        for (std::size_t down = top; down < std::min(top + 4, rows); ++down)
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
