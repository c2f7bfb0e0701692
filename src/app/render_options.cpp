// Reading the arguments of `pse render`.
#include "app/render_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cctype>
#include <cstdlib>
#include <filesystem>

#include "image/ocio.h"
#include "image/sequence.h"
#include "surface/shape_words.h"

namespace pse::app {
namespace {

bool is_variable_name(std::string_view text) {
  const auto letter = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) == 0 &&
         std::all_of(text.begin(), text.end(), letter);
}

// RES, CLIP and XFORM may stand among the arguments as the 2002 chapter's special parameters: they
// are options.
bool take_special(const std::string& name, const std::string& value, Arguments& arguments) {
  for (const auto& [special, option] :
       {std::pair{"RES", "res"}, {"CLIP", "clip"}, {"XFORM", "xform"}}) {
    if (name != special) continue;
    arguments.options[option] = {{value, name}};
    return true;
  }
  return false;
}

// `module.Name`, the knob of an imported file.
bool is_knob_of_module(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && is_variable_name(name.substr(0, dot)) &&
         is_variable_name(name.substr(dot + 1)) &&
         std::isupper(static_cast<unsigned char>(name[dot + 1])) != 0;
}

// Sorts the arguments into program, images and knobs.
void sort_words(RenderOptions& options, Arguments& arguments) {
  for (const std::string& word : arguments.positionals) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (equals != std::string::npos && is_knob_of_module(name)) {
      options.knob_words.push_back(word);
      continue;
    }
    if (equals == std::string::npos || !is_variable_name(name)) {
      if (options.program.empty())
        options.program = word;
      else
        options.images.push_back({"", word});
    } else if (std::isupper(static_cast<unsigned char>(name.front())) != 0) {
      if (!take_special(name, word.substr(equals + 1), arguments))
        options.knob_words.push_back(word);
    } else {
      if (word.size() == equals + 1) throw usage_error(fmt::format("`{}` names no image", word));
      options.images.push_back({name, word.substr(equals + 1)});
    }
  }
  if (options.program.empty())
    throw usage_error("there is nothing to render", "pse render PROGRAM -o FILE");
}

// `--on torus minor=0.2` without quotes: the setting is taken for an image.
void check_settings_are_with_shape(const RenderOptions& options) {
  const std::string shape = options.on.substr(0, options.on.find(' '));
  for (const ImageRequest& image : options.images)
    if (!image.name.empty() && surface::has_setting(shape, image.name) &&
        !std::filesystem::exists(image.file))
      throw usage_error(fmt::format("`{0}={1}` is taken for an image, and there is no file {1}",
                                    image.name, image.file),
                        fmt::format("a setting of the shape stands with it in quotes: "
                                    "--on \"{} {}={}\"",
                                    options.on, image.name, image.file));
}

// --insert and --rule.
void read_insertions(const Arguments& arguments, RenderOptions& options) {
  for (const OptionValue& value : arguments.all("insert")) {
    const std::size_t equals = value.text.find('=');
    const std::string name = value.text.substr(0, equals);
    const bool named = equals != std::string::npos && is_variable_name(name);
    const ImageRequest table = {named ? name : "",
                                named ? value.text.substr(equals + 1) : value.text};
    if (table.file.empty())
      throw usage_error(fmt::format("{}: `{}` names no file", value.origin, value.text));
    for (const ImageRequest& other : options.insertions)
      if (other.name == table.name)
        throw usage_error(fmt::format("two inserted tables are called `{}`", table.name));
    for (const ImageRequest& image : options.images)
      if (image.name == table.name && named)
        throw usage_error(fmt::format("an image and a table are both called `{}`", table.name));
    options.insertions.push_back(table);
  }
  for (const OptionValue& value : arguments.all("rule")) {
    const std::size_t equals = std::min(value.text.find('='), value.text.size());
    const std::string rule = value.text.substr(std::min(equals + 1, value.text.size()));
    const auto known = image::rule_from_name(rule);
    if (!known || equals == 0)
      throw usage_error(fmt::format("{} takes NAME=RULE, not `{}`", value.origin, value.text),
                        "the rules are sum, max, mean and nearest");
    options.rules.push_back({value.text.substr(0, equals), rule, *known});
  }
}

void check_images(const RenderOptions& options) {
  std::vector<std::string> names;
  int standard_inputs = options.program == "-" ? 1 : 0;
  for (const ImageRequest& image : options.images) {
    standard_inputs += image.file == "-" ? 1 : 0;
    if (std::find(names.begin(), names.end(), image.name) != names.end())
      throw usage_error(image.name.empty()
                            ? fmt::format("`{}` is the second image without a name", image.file)
                            : fmt::format("two images are called `{}`", image.name),
                        image.name.empty() ? fmt::format("give it one: bg={}", image.file) : "");
    names.push_back(image.name);
  }
  if (standard_inputs > 1) throw usage_error("standard input can be read only once");
}

std::vector<OutputRequest> output_requests(const Arguments& arguments) {
  std::vector<OutputRequest> outputs;
  int standard_outputs = 0;
  for (const OptionValue& value : arguments.all("output")) {
    OutputRequest output{{}, value.text};
    const std::size_t equals = value.text.find('=');
    if (equals != std::string::npos) {
      const std::vector<std::string> names = split(value.text.substr(0, equals), ",");
      if (std::all_of(names.begin(), names.end(), is_variable_name) && !names.empty())
        output = {names, value.text.substr(equals + 1)};
    }
    if (output.file.empty())
      throw usage_error(fmt::format("{}: `{}` names no file", value.origin, value.text));
    if (const auto pattern = image::canonical_pattern(output.file); !pattern)
      throw usage_error(pattern.error());
    standard_outputs += output.file == "-" ? 1 : 0;
    for (const OutputRequest& other : outputs)
      if (other.file == output.file)
        throw usage_error(fmt::format("two outputs go to `{}`", output.file));
    outputs.push_back(std::move(output));
  }
  if (standard_outputs > 1) throw usage_error("only one output can go to standard output");
  if (const auto layers = arguments.value("layers"))
    for (OutputRequest& output : outputs)
      if (output.variables.empty()) output.variables = split(layers->text, ", ");
  return outputs;
}

// `--display srgb|filmic|none`, or a display and `--view` of $OCIO's configuration, which is asked
// now: a wrong name should not cost a rendering.
void read_display(const Arguments& arguments, image::WriteOptions& write) {
  const bool has_view = arguments.has("view");
  const std::string display = arguments.text_or("display", has_view ? "ocio" : "srgb");
  const bool own = display == "srgb" || display == "filmic" || display == "none";
  if (own && has_view)
    throw usage_error(
        fmt::format("--view is one of an OpenColorIO display, and `{}` is not", display),
        "--display ocio, or a display of the configuration that $OCIO names");
  write.tone =
      own ? *image::tone_from_name(display == "none" ? "raw" : display) : image::Tone::ocio;
  if (own) return;
  const char* config = std::getenv("OCIO");
  if (display != "ocio" && (config == nullptr || *config == '\0'))
    throw usage_error(fmt::format("--display is srgb, filmic or none, not `{}`", display),
                      "other displays are those of the OpenColorIO configuration that the "
                      "environment variable OCIO names, and it names none");
  write.ocio = {display == "ocio" ? "" : display, arguments.text_or("view", "")};
  if (const auto view = image::open_ocio_view(write.working, write.ocio); !view)
    throw Failure(view.error().kind == image::ErrorKind::cannot_read && config != nullptr
                      ? Exit::input
                      : Exit::usage,
                  view.error().message);
}

void read_write_options(const Arguments& arguments, RenderOptions& options) {
  image::WriteOptions& write = options.write;
  write.format = arguments.text_or("format", "");
  write.compression = *image::compression_from_name(arguments.text_or("compression", "zip"));
  write.working = *image::colour_space_from_name(arguments.text_or("colorspace", "lin_rec709"));
  read_display(arguments, write);
  write.bits = arguments.text_or("bits", "8") == "16" ? 16 : 8;
  if (arguments.has("tiled")) write.tile_width = write.tile_height = 64;
  options.nan = *image::nan_policy_from_name(arguments.text_or("nan", "keep"));
  if (arguments.has("half") && arguments.has("float"))
    throw usage_error("--half and --float exclude each other");
  if (arguments.has("half")) options.storage = image::PixelType::float16;
  if (arguments.has("float")) options.storage = image::PixelType::float32;
}

// `procedural`, `none`, `supersample=N`; --samples N is the last.
void read_antialias(const Arguments& arguments, RenderOptions& options) {
  antialias::Options& antialias = options.antialias;
  constexpr int most_samples = 65536;
  const auto supersample = [&](const OptionValue& count) {
    antialias.mode = antialias::Mode::supersample;
    antialias.samples = parse_integer(count, 1, most_samples);
    options.antialias_text = fmt::format("supersample={}", antialias.samples);
  };
  if (const auto value = arguments.value("antialias")) {
    constexpr std::string_view many = "supersample=";
    if (value->text == "none")
      antialias.mode = antialias::Mode::none;
    else if (value->text.starts_with(many))
      supersample({value->text.substr(many.size()), value->origin});
    else if (value->text != "procedural")
      throw usage_error(fmt::format("{} is procedural, supersample=N or none, not `{}`",
                                    value->origin, value->text));
    if (antialias.mode != antialias::Mode::supersample) options.antialias_text = value->text;
    if (arguments.has("samples"))
      throw usage_error("--antialias and --samples exclude each other");
  }
  if (const auto value = arguments.value("samples")) supersample(*value);
  if (const auto value = arguments.value("filter")) {
    const std::size_t star = std::min(value->text.find('*'), value->text.size());
    const auto kind = antialias::filter_named(value->text.substr(0, star));
    double width = 1;
    if (!kind || (star < value->text.size() &&
                  (!read_number(value->text.substr(star + 1), width) || !(width >= 0.25) ||
                   !(width <= 4))))
      throw usage_error(fmt::format("{} is not `{}`", value->origin, value->text),
                        "cubic, box, disc, cone, paraboloid or gauss, and as cubic*1.5 a width "
                        "from 0.25 to 4");
    antialias.filter = antialias::Filter(*kind, static_cast<float>(width));
    options.filter_text = value->text;
  }
}

// "z=0.25": the axis and the place on it.
std::pair<int, double> parse_slice(const OptionValue& value) {
  const std::string axes = "xyz";
  const std::size_t equals = value.text.find('=');
  double place = 0;
  const bool good = equals == 1 && axes.find(value.text[0]) != std::string::npos &&
                    read_number(value.text.substr(2), place) && std::isfinite(place);
  if (!good)
    throw usage_error(
        fmt::format("{} takes an axis and a place, not `{}`", value.origin, value.text),
        "--slice z=0");
  return {static_cast<int>(axes.find(value.text[0])), place};
}

// Refuses a matrix that leaves nothing of the picture's plane; one that makes a line of it may be
// meant.
void check_transform(const PlaneTransform& m, const OptionValue& value) {
  const auto none = [&](std::initializer_list<std::size_t> places) {
    return std::ranges::all_of(places, [&](std::size_t i) { return m[i] == 0; });
  };
  const char* hint = "1, 0, 0, 0, 1, 0 leaves all places where they are";
  if (none({12, 13, 15}))
    throw usage_error(
        fmt::format("{} divides all places by 0: the last row of `{}`", value.origin, value.text),
        hint);
  if (none({0, 1, 4, 5, 8, 9, 12, 13}))
    throw usage_error(
        fmt::format("{} moves all pixels to one place: `{}`", value.origin, value.text), hint);
}

// The picture's plane laid into space: seen from the positive side of the axis, with y up where
// that can be.
PlaneTransform slice_transform(const std::pair<int, double>& slice,
                               const std::optional<PlaneTransform>& before) {
  const double at = slice.second;
  const PlaneTransform lay = slice.first == 0   ? PlaneTransform{0, 0, 1, at, 0,  1, 0, 0,
                                                                 -1, 0, 0, 0,  0,  0, 0, 1}
                             : slice.first == 1 ? PlaneTransform{1, 0,  0, 0, 0, 0, 1, at,
                                                                 0, -1, 0, 0, 0, 0, 0, 1}
                                                : PlaneTransform{1, 0, 0, 0, 0, 1, 0, 0,
                                                                 0, 0, 1, at, 0, 0, 0, 1};
  if (!before) return lay;
  PlaneTransform both{};
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t k = 0; k < 4; ++k) both[4 * r + c] += lay[4 * r + k] * (*before)[4 * k + c];
  return both;
}

}  // namespace

RenderOptions render_options(const Session& session) {
  Arguments arguments = session.arguments;
  RenderOptions options;
  sort_words(options, arguments);
  check_images(options);
  read_insertions(arguments, options);
  options.outputs = output_requests(arguments);

  // The picture.
  if (const auto value = arguments.value("res")) options.resolution = parse_resolution(*value);
  options.clip = arguments.value("clip");
  if (const auto value = arguments.value("xform")) {
    options.transform = plane_transform(parse_numbers(*value));
    if (!options.transform)
      throw usage_error(
          fmt::format("{} takes 6, 9 or 16 numbers, not `{}`", value->origin, value->text),
          "2, 0, 0.5, 0, 2, 0 scales by 2 and moves x by 0.5");
    check_transform(*options.transform, *value);
  }
  if (const auto value = arguments.value("slice")) {
    options.slice = parse_slice(*value);
    options.transform = slice_transform(*options.slice, options.transform);
  }
  if (const auto value = arguments.value("prepass")) {
    options.prepass = parse_integer(*value, 1, 64);
    if (options.slice)
      throw usage_error("--slice follows no rays that --prepass could shorten",
                        "give one of the two");
  }
  options.prepass_image = arguments.text_or("prepass-image", "");
  options.count_evaluations = arguments.has("stats");
  if (const auto value = arguments.value("frames")) {
    const auto frames = image::parse_frames(value->text);
    if (!frames)
      throw usage_error(fmt::format("{}: {}", value->origin, frames.error()),
                        "for example: 1-100, 1-100x5, 1,5,9");
    options.frames = *frames;
  }
  if (const auto value = arguments.value("fps")) options.fps = parse_number(*value, 1e-3, 1e6);
  if (const auto value = arguments.value("seed"))
    options.seed = static_cast<std::uint32_t>(parse_integer(*value, 0, 1 << 24));

  options.on = arguments.text_or("on", "");
  if (!options.on.empty()) check_settings_are_with_shape(options);
  options.camera = arguments.text_or("camera", "");
  options.scene = arguments.text_or("scene", "");
  if (std::filesystem::path(options.program).extension() == ".toml") {
    if (!options.scene.empty())
      throw usage_error("the program is a scene, and --scene names another");
    options.scene = options.program;
  }
  options.trace = arguments.command != nullptr && arguments.command->name == "trace";
  if (options.trace) {
    if (options.scene.empty()) options.on = options.program;
    if (options.storage && *options.storage == image::PixelType::float16)
      throw usage_error("places need all 32 bits", "leave out --half");
    options.antialias.mode = antialias::Mode::none;
  }

  // How it is computed.
  read_antialias(arguments, options);
  if (const auto value = arguments.value("threads"))
    options.threads = parse_integer(*value, 0, 1024);
  if (const auto value = arguments.value("tile")) options.tile = parse_integer(*value, 1, 4096);
  if (const auto value = arguments.value("width")) options.width = parse_integer(*value, 0, 32);
  options.interpret = arguments.has("interpret");
  options.optimize = !arguments.has("no-optimize");
  options.cache = !arguments.has("no-cache");
  // Who asks for a width asks for LLVM's kernel; the first tier has one of its own.
  const std::string tier = arguments.text_or("tier", options.width > 0 ? "optimised" : "auto");
  if (tier == "first" && options.width > 0)
    throw Failure(Exit::usage,
                  "--width is a choice of the optimised code: leave it out, or take --tier "
                  "optimised");
  options.tier = tier == "first"       ? Tier::first
                 : tier == "optimised" ? Tier::optimised
                                       : Tier::automatic;

  // How it is stored.
  read_write_options(arguments, options);
  options.resume = arguments.has("resume");
  options.provenance = !arguments.has("no-provenance");
  if (options.resume && !options.provenance)
    throw usage_error("--resume needs the provenance that --no-provenance leaves out");
  return options;
}

}  // namespace pse::app
