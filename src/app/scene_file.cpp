// Reading scenes. Every key is taken out of its table by name; what is left over is unknown.
#include "app/scene_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "app/failure.h"
#include "app/text_file.h"
#include "diag/diagnostics.h"

namespace pse::app {
namespace {

using surface::Vec3;

int line_of(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

// One table being read.
class Reader {
 public:
  Reader(const toml::table& table, const std::string& file, std::string what)
      : table_(table), file_(file), what_(std::move(what)) {}

  [[noreturn]] void fail(int line, const std::string& message, const std::string& hint = {}) const {
    throw Failure(Exit::input, fmt::format("{}:{}: {}", file_, line, message), hint);
  }
  int line() const { return line_of(table_); }

  const toml::node* take(const char* key) {
    known_.emplace_back(key);
    return table_.get(key);
  }
  bool text(const char* key, std::string& value) {
    const toml::node* node = take(key);
    if (node == nullptr) return false;
    const auto* text = node->as_string();
    if (text == nullptr) fail(line_of(*node), fmt::format("`{}` is a text in quotes", key));
    value = text->get();
    return true;
  }
  bool number(const char* key, double& value, double least, double most) {
    const toml::node* node = take(key);
    if (node == nullptr) return false;
    const auto given = node->value<double>();
    if (!given || !(*given >= least && *given <= most))
      fail(line_of(*node), fmt::format("`{}` is a number from {:g} to {:g}", key, least, most));
    value = *given;
    return true;
  }
  bool vector(const char* key, Vec3& value, bool one_for_all = false) {
    const toml::node* node = take(key);
    if (node == nullptr) return false;
    std::vector<double> numbers;
    collect(*node, numbers);
    if (numbers.size() == 1 && one_for_all) numbers.assign(3, numbers.front());
    if (numbers.size() != 3) fail(line_of(*node), fmt::format("`{}` is a list of 3 numbers", key));
    value = {numbers[0], numbers[1], numbers[2]};
    if (!surface::is_finite(value)) fail(line_of(*node), fmt::format("`{}` is not finite", key));
    return true;
  }
  // Numbers of a list, of lists in it, or one number; stays empty for others.
  static void collect(const toml::node& node, std::vector<double>& numbers) {
    if (const auto* array = node.as_array()) {
      for (const toml::node& element : *array) collect(element, numbers);
    } else if (const auto* truth = node.as_boolean()) {
      numbers.push_back(truth->get() ? 1 : 0);
    } else if (const auto value = node.value<double>()) {
      numbers.push_back(*value);
    }
  }
  void finish() const {
    for (const auto& [key, node] : table_) {
      const std::string name(key.str());
      if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
      const std::string near = nearest_name(name, known_);
      fail(line_of(node), fmt::format("{} has no key `{}`", what_, name),
           near.empty() ? fmt::format("it has {}", fmt::join(known_, ", "))
                        : fmt::format("did you mean `{}`?", near));
    }
  }
  const toml::table& table() const { return table_; }
  const std::vector<std::string>& known() const { return known_; }

 private:
  const toml::table& table_;
  const std::string& file_;
  std::string what_;
  std::vector<std::string> known_;
};

void check_view(const SceneCamera& c, const auto& fail) {
  const surface::Camera& camera = c.camera;
  if (!c.has_eye) return;
  const Vec3 way = camera.target - camera.eye;
  if (!(dot(way, way) > 0)) fail("the camera's eye is at its target");
  if (!camera.has_upright()) fail("the camera looks along its `up`");
}

SceneCamera read_camera(Reader reader) {
  SceneCamera c;
  c.has_eye = reader.vector("eye", c.camera.eye);
  c.has_target = reader.vector("target", c.camera.target);
  reader.vector("up", c.camera.up);
  c.has_fov = reader.number("fov", c.camera.fov, 0.01, 170);
  reader.number("height", c.camera.height, 0, 1e9);
  reader.number("orbit", c.orbit, -1e6, 1e6);
  reader.finish();
  if (c.has_target && !c.has_eye) reader.fail(reader.line(), "a camera with `target` needs `eye`");
  check_view(c, [&](const char* message) { reader.fail(reader.line(), message); });
  return c;
}

surface::Light read_light(Reader reader) {
  surface::Light light;
  const bool far = reader.vector("direction", light.position);
  light.is_lamp = reader.vector("position", light.position);
  if (far == light.is_lamp)
    reader.fail(reader.line(), "a light has a `direction`, towards it, or a `position`");
  if (far && !(dot(light.position, light.position) > 0))
    reader.fail(reader.line(), "a light's direction is not [0, 0, 0]");
  reader.vector("color", light.color, true);
  double intensity = 1, angle = 0;
  if (reader.number("intensity", intensity, 0, 1e12)) light.color = intensity * light.color;
  reader.number("radius", light.radius, 0, 1e9);
  if (reader.number("angle", angle, 0, 90) && far)
    light.radius = std::tan(angle * std::numbers::pi / 360);
  reader.finish();
  return light;
}

std::string knob_text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  std::vector<double> numbers;
  Reader::collect(node, numbers);
  if (numbers.size() == 1 && !node.is_array()) return fmt::format("{}", numbers.front());
  return fmt::format("[{}]", fmt::join(numbers, " "));
}

SceneObject read_object(Reader reader, const std::string& file) {
  SceneObject object;
  object.line = reader.line();
  std::string words;
  if (!reader.text("shape", words))
    reader.fail(reader.line(), "an object needs a `shape`",
                R"(shape = "sphere", or a mesh: shape = "bunny.obj")");
  // As behind --on, settings may stand in the same words.
  auto shape = surface::parse_shape(words);
  if (!shape) reader.fail(reader.line(), shape.error().message, shape.error().hint);
  object.shape = std::move(*shape);
  object.shape.line = object.line;
  for (surface::Setting& setting : object.shape.settings) setting.line = object.line;
  object.name = object.shape.shape;
  reader.text("name", object.name);
  reader.text("program", object.program);
  Placement& place = object.placement;
  reader.vector("at", place.at), reader.vector("turn", place.turn);
  reader.vector("scale", place.scale, true);
  reader.vector("move", place.move), reader.vector("spin", place.spin);
  if (place.scale.x * place.scale.y * place.scale.z == 0)
    reader.fail(reader.line(), "an object's `scale` is not 0");
  if (const toml::node* knobs = reader.take("knobs")) {
    const toml::table* table = knobs->as_table();
    if (table == nullptr) reader.fail(line_of(*knobs), "`knobs` is a table: { Veins = 4 }");
    for (const auto& [key, node] : *table)
      object.knobs.push_back({std::string(key.str()), knob_text_of(node),
                              fmt::format("{}:{}", file, line_of(node))});
  }
  // What is left sets up the shape.
  for (const auto& [key, node] : reader.table()) {
    const std::string name(key.str());
    if (std::find(reader.known().begin(), reader.known().end(), name) != reader.known().end())
      continue;
    surface::Setting setting{name, {}, "", line_of(node)};
    if (const auto* text = node.as_string()) setting.text = text->get();
    Reader::collect(node, setting.numbers);
    object.shape.settings.push_back(std::move(setting));
  }
  return object;
}

void read_tables(Reader& reader, const char* key, const std::string& file, const auto& add) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i)
    if (const toml::table* table = (*array)[i].as_table()) {
      add(Reader(*table, file, fmt::format("[[{}]]", key)));
    } else {
      array = nullptr;
      break;
    }
  if (array == nullptr)
    reader.fail(line_of(*node), fmt::format("write [[{0}]], in two brackets, above each {0}", key));
}

}  // namespace

surface::Affine Placement::at_time(double seconds) const {
  const Vec3 angle = (std::numbers::pi / 180) * (turn + seconds * spin);
  const Vec3 c{std::cos(angle.x), std::cos(angle.y), std::cos(angle.z)},
      s{std::sin(angle.x), std::sin(angle.y), std::sin(angle.z)};
  const surface::Affine x{{1, 0, 0}, {0, c.x, s.x}, {0, -s.x, c.x}, {}},
      y{{c.y, 0, -s.y}, {0, 1, 0}, {s.y, 0, c.y}, {}},
      z{{c.z, s.z, 0}, {-s.z, c.z, 0}, {0, 0, 1}, {}},
      size{{scale.x, 0, 0}, {0, scale.y, 0}, {0, 0, scale.z}, {}};
  surface::Affine map = z * (y * (x * size));
  map.offset = at + seconds * move;
  return map;
}

SceneFile read_scene_file(const std::string& path) {
  SceneFile scene;
  scene.path = path;
  toml::table root;
  try {
    root = toml::parse(read_text_file(path), path);
  } catch (const toml::parse_error& error) {
    throw Failure(Exit::input, fmt::format("{}:{}: {}", path, error.source().begin.line,
                                           error.description()));
  }
  Reader reader(root, path, "a scene");
  reader.text("program", scene.program);
  reader.text("background", scene.background);
  if (const toml::node* camera = reader.take("camera")) {
    const toml::table* table = camera->as_table();
    if (table == nullptr) reader.fail(line_of(*camera), "write [camera] above the camera's keys");
    scene.camera = read_camera(Reader(*table, path, "[camera]"));
  }
  if (const toml::node* lights = reader.take("lights"))
    reader.fail(line_of(*lights), "a scene has no key `lights`",
                "write [[light]] above each light");
  scene.has_lights = root.contains("light");
  read_tables(reader, "light", path,
              [&](Reader table) { scene.lights.push_back(read_light(std::move(table))); });
  read_tables(reader, "object", path,
              [&](Reader table) { scene.objects.push_back(read_object(std::move(table), path)); });
  reader.finish();
  if (scene.objects.empty())
    throw Failure(Exit::input, fmt::format("{}: the scene has no objects", path),
                  "write [[object]] and below it shape = \"sphere\"");
  return scene;
}

SceneCamera parse_camera(const std::string& words) {
  // The words are the keys of [camera] in another dress.
  std::string text;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    const std::string word = words.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
      throw usage_error(fmt::format("--camera: `{}` is not KEY=NUMBERS", word),
                        "--camera 'eye=3,2,4 target=0,0,0 fov=35'");
    const std::string numbers = word.substr(equals + 1);
    text += word.substr(0, equals) + " = " +
            (numbers.find(',') == std::string::npos ? numbers : "[" + numbers + "]") + "\n";
  }
  try {
    const toml::table table = toml::parse(text);
    return read_camera(Reader(table, words, "--camera"));
  } catch (const toml::parse_error&) {
    throw usage_error(fmt::format("--camera cannot be read: `{}`", words),
                      "--camera 'eye=3,2,4 target=0,0,0 fov=35'");
  } catch (const Failure& failure) {
    const std::string message = failure.what();
    const std::size_t colon = message.find(": ");
    throw usage_error("--camera: " + message.substr(colon == std::string::npos ? 0 : colon + 2),
                      failure.hint());
  }
}

}  // namespace pse::app
