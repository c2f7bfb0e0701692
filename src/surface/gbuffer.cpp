// From stored channels to the names of surfaces. Layers are copied; what a renderer did not store
// is worked out from the rest.
#include "surface/gbuffer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <sstream>

namespace pse::surface {
namespace {

struct Known {
  const char* name;
  std::size_t components;
  std::vector<std::string_view> layers;  // in lower case, best first
};

const std::vector<Known>& known_layers() {
  static const std::vector<Known> all = {
      {"point", 3, {"point", "pref", "position", "p", "worldposition", "place"}},
      {"place", 3, {"place", "p", "position", "worldposition", "point"}},
      {"normal", 3, {"normal", "n", "worldnormal", "normals"}},
      {"uv", 2, {"uv", "st", "texcoord"}},
      {"id", 1, {"id", "indexob", "objectid", "objectindex"}},
      {"depth", 1, {"depth", "z"}},
      {"hit", 1, {"hit", "alpha"}},
      {"direction", 3, {"direction", "raydirection"}},
      {"backface", 1, {"backface"}},
      {"pixelsize", 1, {"pixelsize"}},
      {"flat_normal", 3, {"flat_normal", "ng"}},
      {"dPdx", 3, {"dpdx"}},
      {"dPdy", 3, {"dpdy"}},
      {"axis_x", 3, {"axis_x"}},
      {"axis_y", 3, {"axis_y"}},
      {"axis_z", 3, {"axis_z"}}};
  return all;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool is_called(const std::string& layer, std::string_view name) {
  const std::string text = lower(layer);
  if (text == name) return true;
  return text.size() > name.size() + 1 && text.ends_with(name) &&
         text[text.size() - name.size() - 1] == '_';
}

std::string light_name(std::size_t light, const char* what) {
  return "light" + (light == 0 ? "" : std::to_string(light + 1)) + "_" + what;
}

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}
std::string numbers(const Vec3& v) { return number(v.x) + " " + number(v.y) + " " + number(v.z); }

// Which layer holds the slopes of `point` that an input ("point.0$x") is one of.
const char* slope_layer(const std::string& input) { return input.back() == 'x' ? "dPdx" : "dPdy"; }

}  // namespace

SurfaceLayers surface_layers(std::span<const image::Layer> layers) {
  SurfaceLayers found;
  for (const Known& known : known_layers())
    for (const std::string_view candidate : known.layers) {
      for (const image::Layer& layer : layers) {
        if (found.contains(known.name)) break;
        const std::size_t has = layer.channels.size();
        // A third coordinate beside u and v does no harm.
        const bool fits = has == known.components || (known.components == 2 && has == 3);
        if (fits && is_called(layer.name, candidate)) found[known.name] = layer.name;
      }
    }
  return found.contains("point") && found.contains("normal") ? found : SurfaceLayers{};
}

std::map<std::string, std::string> gbuffer_attributes(const GBufferFrame& frame) {
  std::map<std::string, std::string> attributes;
  if (frame.eye) attributes["pse/eye"] = numbers(*frame.eye);
  std::string lights;
  for (const Light& light : frame.lights)
    lights += (light.is_lamp ? "lamp " : "far ") + numbers(light.position) + " " +
              numbers(light.color) + " " + number(light.radius) + "\n";
  attributes["pse/lights"] = lights;
  return attributes;
}

void read_gbuffer_attributes(const std::map<std::string, std::string>& attributes,
                             GBufferFrame& frame) {
  if (const auto eye = attributes.find("pse/eye"); eye != attributes.end()) {
    std::istringstream stream(eye->second);
    Vec3 v;
    if (stream >> v.x >> v.y >> v.z) frame.eye = v;
  }
  if (const auto lights = attributes.find("pse/lights"); lights != attributes.end()) {
    std::istringstream stream(lights->second);
    frame.lights.clear();
    Light light;
    std::string kind;
    while (stream >> kind >> light.position.x >> light.position.y >> light.position.z >>
           light.color.x >> light.color.y >> light.color.z >> light.radius) {
      light.is_lamp = kind == "lamp";
      frame.lights.push_back(light);
    }
  }
}

std::vector<StreamName> gbuffer_names(const SurfaceLayers& layers,
                                      std::span<const image::Layer>,
                                      const GBufferFrame& frame) {
  constexpr ir::Rate sample = ir::Rate::sample;
  std::vector<StreamName> names;
  for (const Known& known : known_layers())
    if (layers.contains(known.name))
      names.push_back({known.name, static_cast<int>(known.components), sample,
                       ir::InputSlopes::of_sample});
  const auto add = [&](const char* name, int components) {
    if (!layers.contains(name)) names.push_back({name, components, sample});
  };
  add("id", 1), add("hit", 1), add("depth", 1), add("pixelsize", 1), add("pixel_freq", 1);
  add("backface", 1);
  if (layers.contains("uv")) add("u", 1), add("v", 1);
  if (frame.eye)
    add("direction", 3), add("origin", 3), names.push_back({"eye", 3, ir::Rate::frame});
  if (frame.eye || layers.contains("direction")) add("view", 3);
  names.push_back({"light_count", 1, ir::Rate::frame});
  for (std::size_t i = 0; i < frame.lights.size(); ++i) {
    names.push_back({light_name(i, "direction"), 3, sample});
    names.push_back({light_name(i, "color"), 3, sample});
    names.push_back({light_name(i, "position"), 3, sample});
    names.push_back({light_name(i, "radius"), 1, sample});
  }
  return names;
}

std::vector<std::string> layers_wanted(const ir::Module& module, const SurfaceLayers& layers) {
  std::vector<std::string> wanted;
  const auto want = [&](const std::string& name) {
    const auto found = layers.find(name);
    if (found == layers.end()) return false;
    if (std::find(wanted.begin(), wanted.end(), found->second) == wanted.end())
      wanted.push_back(found->second);
    return true;
  };
  // Which pixels show anything.
  if (!want("hit") && !want("id") && !want("depth")) want("normal");
  for (const ir::Input& input : module.inputs) {
    if (input.rate != ir::Rate::sample) continue;
    const std::string base = input.name.substr(0, input.name.find('.'));
    if (base == "u" || base == "v") want("uv");
    if (const std::size_t slope = input.name.find('$'); slope != std::string::npos) {
      if (base == "point" && want(slope_layer(input.name))) continue;
      want("id");
    }
    if (want(base)) continue;
    if (base == "view") (void)(want("direction") || want("place"));
    if (base == "direction" || base == "depth") want("place");
    if (base == "pixelsize" || base == "pixel_freq") (void)(want("pixelsize") || want("point"));
    if (base.starts_with("light")) want("place");
  }
  return wanted;
}

GBuffer::GBuffer(const ir::Module& module, const SurfaceLayers& layers,
                 std::span<const image::Layer> all, const image::ImageSpec& spec,
                 std::shared_ptr<const image::Image> picture, const GBufferFrame& frame)
    : picture_(std::move(picture)),
      frame_(frame),
      display_(picture_->spec.display),
      data_(picture_->spec.data) {
  for (const auto& [name, layer_name] : layers) {
    const image::Layer* layer = image::find_layer(all, layer_name);
    for (const int channel : layer->channels) {
      const int plane = picture_->spec.find(spec.channels[static_cast<std::size_t>(channel)].name);
      planes_[name].push_back(
          plane < 0 ? nullptr : picture_->planes[static_cast<std::size_t>(plane)].data());
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    point_[c] = plane_of("point", c), place_[c] = plane_of("place", c);
    normal_[c] = plane_of("normal", c);
  }
  hit_ = plane_of("hit", 0), id_ = plane_of("id", 0), depth_ = plane_of("depth", 0);
  pixelsize_ = plane_of("pixelsize", 0);

  using enum What;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate != ir::Rate::sample) continue;
    const std::size_t dollar = module.inputs[i].name.find('$');
    const std::string full = module.inputs[i].name.substr(0, dollar);
    const std::size_t dot = full.find('.');
    const std::string base = full.substr(0, dot);
    const std::size_t c = dot == std::string::npos ? 0 : std::size_t(full[dot + 1] - '0');
    Wanted wanted{i, layer, c, 0, nullptr};
    if (dollar != std::string::npos) {
      wanted.what = module.inputs[i].name.back() == 'x' ? slope_x : slope_y;
      wanted.plane = plane_of(base, c);
      if (const float* stored = plane_of(slope_layer(module.inputs[i].name), c);
          base == "point" && stored != nullptr)
        wanted.what = layer, wanted.plane = stored;
      if (wanted.plane != nullptr) wanted_.push_back(wanted);
      continue;
    }
    if (base == "u" || base == "v")
      wanted.plane = plane_of("uv", base == "u" ? 0 : 1);
    else if (base == "id")
      wanted.what = id;
    else if (base == "hit")
      wanted.what = hit;
    else if (const float* plane = plane_of(base, c))
      wanted.plane = plane;
    else if (base == "view" && plane_of("direction", c) != nullptr)
      wanted.what = negated, wanted.plane = plane_of("direction", c);
    else if (base == "depth")
      wanted.what = depth;
    else if (base == "direction")
      wanted.what = direction;
    else if (base == "view")
      wanted.what = view;
    else if (base == "pixelsize")
      wanted.what = pixelsize;
    else if (base == "pixel_freq")
      wanted.what = pixel_freq;
    else if (base == "origin" || base == "backface")
      wanted.what = nothing;
    else {
      bool is_light = false;
      for (std::size_t k = 0; k < frame_.lights.size(); ++k)
        for (const auto& [text, what] :
             {std::pair{"direction", light_direction}, {"color", light_color},
              {"position", light_position}, {"radius", light_radius}})
          if (base == light_name(k, text)) wanted.what = what, wanted.light = k, is_light = true;
      if (!is_light) continue;
    }
    if (wanted.what == layer && wanted.plane == nullptr) continue;
    wanted_.push_back(wanted);
  }
}

const float* GBuffer::plane_of(const std::string& name, std::size_t component) const {
  const auto found = planes_.find(name);
  if (found == planes_.end() || component >= found->second.size()) return nullptr;
  return found->second[component];
}

Vec3 GBuffer::vector_at(const Planes3& planes, std::size_t pixel) {
  const auto at = [&](std::size_t c) -> double {
    return planes[c] == nullptr ? 0 : planes[c][pixel];
  };
  return {at(0), at(1), at(2)};
}

bool GBuffer::seen_at(std::size_t pixel) const {
  if (hit_ != nullptr) return hit_[pixel] > 0;
  if (id_ != nullptr) return id_[pixel] > 0;
  if (depth_ != nullptr) return depth_[pixel] < 1e9f;
  const Vec3 n = vector_at(normal_, pixel);
  return dot(n, n) > 0;
}

Vec3 GBuffer::direction_at(std::size_t pixel) const {
  return normalized(vector_at(place_, pixel) - frame_.eye.value_or(Vec3{}));
}

// From the nearer of both neighbours along each axis: across an edge the other one lies far away.
double GBuffer::pixelsize_at(std::size_t pixel) const {
  const auto width = static_cast<std::size_t>(data_.width());
  const std::size_t column = pixel % width;
  const Vec3 p = vector_at(point_, pixel);
  const auto nearer = [&](bool has_before, bool has_after, std::size_t stride) {
    Vec3 best;
    double least = Box::inf;
    if (has_before) best = p - vector_at(point_, pixel - stride), least = dot(best, best);
    if (has_after) {
      const Vec3 step = vector_at(point_, pixel + stride) - p;
      if (dot(step, step) < least) best = step;
    }
    return best;
  };
  const Vec3 across = nearer(column > 0, column + 1 < width, 1);
  const Vec3 down =
      nearer(pixel >= width, pixel + width < static_cast<std::size_t>(data_.pixels()), width);
  return std::sqrt(length(cross(across, down)));
}

// Between the neighbours along an axis that show the same object; with none there is no slope.
float GBuffer::slope_at(const float* plane, bool along_x, std::size_t pixel) const {
  const auto width = static_cast<std::size_t>(data_.width());
  const auto all = static_cast<std::size_t>(data_.pixels());
  const std::size_t stride = along_x ? 1 : width;
  const auto same = [&](bool is_there, std::size_t other) {
    return is_there && seen_at(other) && (id_ == nullptr || id_[other] == id_[pixel]);
  };
  const bool before = along_x ? pixel % width > 0 : pixel >= width;
  const bool after = along_x ? pixel % width + 1 < width : pixel + width < all;
  const bool has_before = same(before, pixel - stride), has_after = same(after, pixel + stride);
  const float low = has_before ? plane[pixel - stride] : plane[pixel];
  const float high = has_after ? plane[pixel + stride] : plane[pixel];
  return (high - low) * (has_before && has_after ? 0.5f : 1.0f);
}

float GBuffer::value(const Wanted& wanted, std::size_t pixel) const {
  const auto part = [&](const Vec3& v) {
    return static_cast<float>(v[static_cast<int>(wanted.component)]);
  };
  const Light* light = wanted.light < frame_.lights.size() ? &frame_.lights[wanted.light] : nullptr;
  switch (wanted.what) {
    case What::layer: return wanted.plane[pixel];
    case What::negated: return -wanted.plane[pixel];
    case What::slope_x: return slope_at(wanted.plane, true, pixel);
    case What::slope_y: return slope_at(wanted.plane, false, pixel);
    case What::id: {
      const bool seen = seen_at(pixel);
      return !seen ? 0 : id_ != nullptr && id_[pixel] >= 1 ? id_[pixel] : 1;
    }
    case What::hit: return seen_at(pixel) ? 1.0f : 0.0f;
    case What::depth:
      return static_cast<float>(length(vector_at(place_, pixel) - frame_.eye.value_or(Vec3{})));
    case What::direction: return part(direction_at(pixel));
    case What::view: return part(-direction_at(pixel));
    case What::pixelsize: return static_cast<float>(pixelsize_at(pixel));
    case What::pixel_freq: {
      const float width =
          pixelsize_ != nullptr ? pixelsize_[pixel] : static_cast<float>(pixelsize_at(pixel));
      return static_cast<float>(0.5 / width);
    }
    case What::nothing: return 0;
    default:
      return part(light_value(*light,
                              wanted.what == What::light_direction  ? LightPart::direction
                              : wanted.what == What::light_color    ? LightPart::color
                              : wanted.what == What::light_position ? LightPart::position
                                                                    : LightPart::radius,
                              vector_at(place_, pixel)));
  }
}

// What a light far away is does not depend on the place, but for where it is said to stand.
bool GBuffer::is_same_everywhere(const Wanted& wanted) const {
  const bool of_light = wanted.what == What::light_direction || wanted.what == What::light_color ||
                        wanted.what == What::light_radius;
  return of_light && !frame_.lights[wanted.light].is_lamp;
}

void GBuffer::fill(std::span<const double> x, std::span<const double> y,
                   std::span<float* const> planes) const {
  // Cut the samples into rows of pixels that lie side by side in the stored planes.
  thread_local std::vector<Row> rows;
  rows.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const int px = static_cast<int>(std::floor(x[i])) + display_.x0,
              py = static_cast<int>(std::floor(y[i])) + display_.y0;
    const std::int64_t pixel =
        data_.contains(px, py)
            ? std::int64_t{py - data_.y0} * data_.width() + (px - data_.x0)
            : outside;
    const bool goes_on =
        !rows.empty() && (pixel == outside ? rows.back().pixel == outside
                                           : rows.back().pixel != outside &&
                                                 rows.back().pixel + rows.back().count == pixel);
    goes_on ? void(++rows.back().count) : rows.push_back({static_cast<std::int64_t>(i), 1, pixel});
  }
  for (const Wanted& wanted : wanted_) {
    float* const plane = planes[wanted.input];
    if (plane == nullptr) continue;
    for (const Row& row : rows) {
      float* const out = plane + row.sample;
      if (row.pixel == outside && !is_same_everywhere(wanted))
        std::fill_n(out, row.count, 0.0f);
      else
        fill_row(wanted, row.pixel, row.count, out);
    }
  }
}

void GBuffer::fill_row(const Wanted& wanted, std::int64_t first, std::int64_t count,
                       float* out) const {
  const auto all = [&](const auto& value_at) {
    for (std::int64_t i = 0; i < count; ++i) out[i] = value_at(static_cast<std::size_t>(first + i));
  };
  if (is_same_everywhere(wanted)) {
    std::fill_n(out, count, value(wanted, 0));
    return;
  }
  const float* const plane = wanted.plane;
  switch (wanted.what) {
    case What::layer: std::copy_n(plane + first, count, out); return;
    case What::negated: return all([&](std::size_t pixel) { return -plane[pixel]; });
    case What::slope_x: return all([&](std::size_t pixel) { return slope_at(plane, true, pixel); });
    case What::slope_y:
      return all([&](std::size_t pixel) { return slope_at(plane, false, pixel); });
    case What::id:
      if (hit_ == nullptr || id_ != nullptr) break;
      return all([&](std::size_t pixel) { return hit_[pixel] > 0 ? 1.0f : 0.0f; });
    default: break;
  }
  all([&](std::size_t pixel) { return value(wanted, pixel); });
}

}  // namespace pse::surface
