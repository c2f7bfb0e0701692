// One table of shapes: name, settings with their usual values, and how each is made.
#include "surface/shape_words.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <sstream>

#include "diag/diagnostics.h"

namespace pse::surface {
namespace {

// The settings of one shape, as numbers.
using Values = std::map<std::string, std::vector<double>>;

struct Parameter {
  const char* name;
  std::vector<double> usual;
  double least, most = std::numeric_limits<double>::infinity();  // what is beyond is refused
  bool any_length = false;
};
struct Kind {
  const char* name;
  std::vector<Parameter> parameters;
  std::function<std::shared_ptr<const Shape>(const Values&)> make;
};

constexpr int most_steps = 20'000;  // half through an isosurface's box
constexpr double tiny = 1e-6, inf = std::numeric_limits<double>::infinity();

double one(const Values& v, const char* name) { return v.at(name).front(); }
Vec3 three(const Values& v, const char* name) {
  const auto& n = v.at(name);
  return n.size() == 1 ? Vec3{n[0], n[0], n[0]} : Vec3{n[0], n[1], n[2]};
}

std::vector<ProfilePoint> profile_of(const std::vector<double>& numbers) {
  std::vector<ProfilePoint> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
    points.push_back({numbers[i], numbers[i + 1]});
  return points;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"sphere",
       {{"radius", {1}, tiny}},
       [](const Values& v) { return make_sphere(one(v, "radius")); }},
      {"torus",
       {{"major", {0.7}, tiny}, {"minor", {0.3}, tiny}},
       [](const Values& v) { return make_torus(one(v, "major"), one(v, "minor")); }},
      {"box",
       {{"size", {1.4, 1.4, 1.4}, tiny}},
       [](const Values& v) { return make_box(three(v, "size")); }},
      {"plane",
       {{"size", {inf}, tiny}},
       [](const Values& v) { return make_plane(one(v, "size")); }},
      {"superquadric",
       {{"size", {1, 1, 1}, tiny}, {"north", {0.5}, 0.05, 4}, {"east", {0.5}, 0.05, 4}},
       [](const Values& v) {
         return make_superquadric(three(v, "size"), one(v, "north"), one(v, "east"));
       }},
      {"vase", {}, [](const Values&) { return make_revolution(vase_profile(), false); }},
      {"revolution",
       {{"profile", {0.5, -1, 0.9, 0, 0.4, 1}, -inf, inf, true}, {"caps", {0}, 0}},
       [](const Values& v) {
         return make_revolution(profile_of(v.at("profile")), one(v, "caps") != 0);
       }}};
  return all;
}

const Kind* find_kind(const std::string& name) {
  for (const Kind& kind : kinds())
    if (name == kind.name) return &kind;
  return nullptr;
}

constexpr const char* settings_come_behind = "settings come behind the name, in quotes: ";

bool is_mesh_name(const std::string& name) { return name.find('.') != std::string::npos; }

const Kind& field_kind() {
  static const Kind kind = {
      "an isosurface",
      {{"level", {0.5}, -inf}, {"bounds", {1.5, 1.5, 1.5}, tiny}, {"step", {0}, 0}},
      {}};
  return kind;
}

bool has(const Kind& kind, const std::string& key) {
  return std::any_of(kind.parameters.begin(), kind.parameters.end(),
                     [&](const Parameter& parameter) { return key == parameter.name; });
}

std::string text_of(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

std::string range_of(const Parameter& parameter) {
  const std::string from = "from " + text_of(parameter.least);
  return parameter.most < inf ? from + " to " + text_of(parameter.most) : from + " up";
}

ShapeError unknown_setting(const Setting& setting, const std::string& shape,
                           const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  const std::string near = nearest_name(setting.key, known);
  return {shape + " has no setting `" + setting.key + "`",
          !near.empty()  ? "did you mean `" + near + "`?"
          : list.empty() ? "it has none"
                         : "it has " + list,
          setting.line, true};
}

// The settings with what is usual in place of those that are not given.
std::expected<Values, ShapeError> values_of(const Kind& kind, const ShapeSpec& spec) {
  Values values;
  std::vector<std::string> known;
  for (const Parameter& parameter : kind.parameters)
    values[parameter.name] = parameter.usual, known.emplace_back(parameter.name);
  for (const Setting& setting : spec.settings) {
    const Parameter* parameter = nullptr;
    for (const Parameter& candidate : kind.parameters)
      if (setting.key == candidate.name) parameter = &candidate;
    if (parameter == nullptr) return std::unexpected(unknown_setting(setting, kind.name, known));
    const std::size_t given = setting.numbers.size(), usual = parameter->usual.size();
    const bool fits = parameter->any_length ? given >= 4 && given % 2 == 0
                                            : given == usual || (given == 1 && usual == 3);
    if (!fits)
      return std::unexpected(ShapeError{
          "`" + setting.key + "` of " + kind.name +
              (parameter->any_length
                   ? " takes pairs of radius and height, two or more"
                   : " takes " + std::to_string(usual) + (usual == 1 ? " number" : " numbers")),
          "", setting.line, true});
    for (const double number : setting.numbers)
      if (!(number >= parameter->least && number <= parameter->most))
        return std::unexpected(ShapeError{"`" + setting.key + "` of " + kind.name + " is " +
                                              text_of(number) + ", and goes " +
                                              range_of(*parameter),
                                          "", setting.line, true});
    values[setting.key] = setting.numbers;
  }
  return values;
}

std::expected<MadeShape, ShapeError> make_mesh(const ShapeSpec& spec, bool fit) {
  MeshOptions options;
  options.fit = fit;
  for (const Setting& setting : spec.settings) {
    if (setting.numbers.size() != 1 && (setting.key == "fit" || setting.key == "crease"))
      return std::unexpected(
          ShapeError{"`" + setting.key + "` takes one number", "", setting.line, true});
    if (setting.key == "fit")
      options.fit = setting.numbers.front() != 0;
    else if (setting.key == "crease")
      options.crease = setting.numbers.front();
    else
      return std::unexpected(unknown_setting(setting, "a mesh", {"fit", "crease"}));
  }
  const auto loaded = load_mesh(spec.shape, options);
  if (!loaded) {
    const std::string quoted = quoted_settings(spec.shape);
    return std::unexpected(
        ShapeError{loaded.error(), quoted.empty() ? "" : settings_come_behind + quoted, spec.line,
                   false});
  }
  const auto shape = make_mesh_shape(loaded->mesh);
  if (!shape) return std::unexpected(ShapeError{shape.error(), "", spec.line, false});
  return MadeShape{*shape, loaded->notes};
}

}  // namespace

std::string quoted_settings(const std::string& words) {
  const std::size_t end = words.find_first_of(" :;,(=?&");
  const std::string name = words.substr(0, end);
  if (end == std::string::npos || (!is_shape_name(name) && !is_mesh_name(name))) return "";
  std::string settings = words.substr(end + 1);
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const char c = settings[i];
    const bool ends_list = c == ',' && (i + 1 == settings.size() || is_letter(settings[i + 1]));
    if (ends_list || (std::strchr("=.,+-_", c) == nullptr && !is_letter(c) && (c < '0' || c > '9')))
      settings[i] = ' ';
  }
  while (settings.ends_with(' ')) settings.pop_back();
  if (settings.find('=') == std::string::npos) {
    const Kind* kind = find_kind(name);
    settings = kind != nullptr && !kind->parameters.empty()
                   ? std::string(kind->parameters.front().name) + "=" +
                         text_of(kind->parameters.front().usual.front())
                   : "fit=false";
  }
  return "\"" + name + " " + settings + "\"";
}

bool has_setting(const std::string& shape, const std::string& key) {
  if (const Kind* kind = find_kind(shape)) return has(*kind, key);
  if (is_field_name(shape)) return has(field_kind(), key);
  return key == "fit" || key == "crease";
}

std::expected<ShapeSpec, ShapeError> parse_shape(const std::string& words) {
  std::istringstream stream(words);
  ShapeSpec spec;
  stream >> spec.shape;
  // A mesh's name may hold spaces.
  if (!is_shape_name(spec.shape) && words.find('=') == std::string::npos) spec.shape = words;
  if (spec.shape.empty()) return std::unexpected(ShapeError{"no shape is named", "", 0, true});
  if (spec.shape == words) return spec;
  for (std::string word; stream >> word;) {
    const std::size_t equals = word.find('=');
    Setting setting{word.substr(0, equals), {}, word, 0};
    const std::string text = equals == std::string::npos ? "" : word.substr(equals + 1);
    const char* at = text.c_str();
    while (*at != '\0') {
      if (text == "true" || text == "false") {
        setting.numbers = {text == "true" ? 1.0 : 0.0};
        break;
      }
      double number = 0;
      const auto [end, problem] = std::from_chars(at, text.data() + text.size(), number);
      if (problem != std::errc() || (*end != ',' && *end != '\0')) {
        setting.numbers.clear();
        break;
      }
      setting.numbers.push_back(number);
      at = *end == ',' ? end + 1 : end;
    }
    if (setting.numbers.empty())
      return std::unexpected(ShapeError{
          "`" + word + "` is no setting of a shape",
          std::count(word.begin(), word.end(), '=') > 1
              ? settings_come_behind + quoted_settings(spec.shape + " " + word)
              : "for example: torus minor=0.3",
          0, true});
    spec.settings.push_back(std::move(setting));
  }
  return spec;
}

std::vector<std::pair<std::string, std::string>> shape_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const Kind& kind : kinds()) {
    std::string text;
    for (const Parameter& parameter : kind.parameters) {
      text += (text.empty() ? "" : " ") + std::string(parameter.name) + "=";
      for (std::size_t i = 0; i < parameter.usual.size(); ++i)
        text += (i == 0 ? "" : ",") + text_of(parameter.usual[i]);
    }
    names.emplace_back(kind.name, text);
  }
  return names;
}

bool is_shape_name(const std::string& name) { return find_kind(name) != nullptr; }

bool is_field_name(const std::string& name) { return name.ends_with(".pse"); }

std::expected<MadeShape, ShapeError> make_field_shape(const ShapeSpec& spec, Field field) {
  const auto values = values_of(field_kind(), spec);
  if (!values) return std::unexpected(values.error());
  const Vec3 half = three(*values, "bounds");
  const double step = one(*values, "step");
  if (step > 0 && step < length(half) / most_steps)
    return std::unexpected(ShapeError{
        "`step` of an isosurface is " + text_of(step) + ", less than a " +
            std::to_string(most_steps) + "th of its box: rays would be on their way for ever",
        "at least " + text_of(length(half) / most_steps), spec.line, true});
  return MadeShape{make_isosurface(std::move(field), one(*values, "level"), {-half, half},
                                   step > 0 ? step : length(half) / 100),
                   {}};
}

std::expected<MadeShape, ShapeError> make_shape(const ShapeSpec& spec, bool fit_meshes) {
  const Kind* kind = find_kind(spec.shape);
  if (kind == nullptr) {
    if (is_mesh_name(spec.shape)) return make_mesh(spec, fit_meshes);
    std::vector<std::string> names;
    std::string list;
    for (const Kind& known : kinds())
      names.emplace_back(known.name), list += std::string(known.name) + ", ";
    const std::string near = nearest_name(spec.shape, names), quoted = quoted_settings(spec.shape);
    const std::string hint = !quoted.empty() ? settings_come_behind + quoted
                             : near.empty()
                                 ? "shapes are " + list + "and meshes: .obj .ply .gltf .glb"
                                 : "did you mean `" + near + "`?";
    return std::unexpected(
        ShapeError{"there is no shape `" + spec.shape + "`", hint, spec.line, true});
  }
  const auto values = values_of(*kind, spec);
  if (!values) return std::unexpected(values.error());
  return MadeShape{kind->make(*values), {}};
}

}  // namespace pse::surface
