// Recipes and attributes.
#include "app/provenance.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "app/input_images.h"
#include "app/knobs.h"
#include "app/version.h"
#include "base/hash.h"

namespace pse::app {
namespace {

std::string knobs_text(const std::vector<Knob>& knobs) {
  std::string text;
  for (const Knob& knob : knobs) text += fmt::format("{}={}\n", knob.name, knob_text(knob));
  return text;
}

}  // namespace

std::string recipe(const RenderContext& context, const PlannedFile& file) {
  Hasher hasher;
  hasher.add(version);

  // The program with all that it imports.
  for (FileId id = 0; id < context.sources.size(); ++id) hasher.add(context.sources.file(id).text);
  hasher.add(knobs_text(context.knobs));
  for (const auto& [name, identity] : context.inputs) hasher.add(name), hasher.add(identity);

  // The picture.
  const ImagePlane& plane = context.plane;
  for (const int value : {plane.width, plane.height, context.window.x0, context.window.y0,
                          context.window.x1, context.window.y1})
    hasher.add(value);
  hasher.add(plane.seed);
  hasher.add(context.options.antialias_text);
  hasher.add(context.options.filter_text);
  const PlaneTransform transform = plane.transform.value_or(PlaneTransform{});
  for (const double value : {plane.frame, plane.fps}) hasher.add(fmt::format("{}", value));
  for (const double value : transform) hasher.add(fmt::format("{}", value));

  // How it is stored.
  const image::WriteOptions& write = file.write;
  hasher.add(write.format);
  for (const int value : {static_cast<int>(write.compression), write.tile_width, write.tile_height,
                          static_cast<int>(write.working), static_cast<int>(write.tone), write.bits,
                          write.quality, static_cast<int>(context.options.nan)})
    hasher.add(value);
  if (write.tone == image::Tone::ocio) {
    const char* config = std::getenv("OCIO");
    for (const std::string& text : {write.ocio.display, write.ocio.view,
                                    file_identity(config != nullptr ? config : "-")})
      hasher.add(text);
  }
  for (const PlannedChannel& channel : file.channels) {
    hasher.add(channel.channel.name);
    hasher.add(static_cast<int>(channel.channel.type));
    hasher.add(context.program.module().outputs[channel.output].name);
  }
  return hasher.finish().text();
}

std::map<std::string, std::string> provenance(const RenderContext& context) {
  std::map<std::string, std::string> attributes = {
      {"pse/version", std::string(version)},
      {"pse/program", context.sources.file(context.file).text},
      {"pse/knobs", knobs_text(context.knobs)},
      {"pse/seed", fmt::format("{}", context.plane.seed)},
      {"pse/frame", fmt::format("{}", context.plane.frame)},
  };
  std::string inputs;
  for (const auto& [name, identity] : context.inputs) inputs += name + "\n";
  if (!inputs.empty()) attributes["pse/inputs"] = inputs;
  return attributes;
}

bool is_done(const std::string& name, const std::string& recipe) {
  std::error_code error;
  if (name == "-" || !std::filesystem::is_regular_file(name, error)) return false;
  const auto reader = image::open_reader(name);
  if (!reader) return false;
  const auto& attributes = (*reader)->spec().attributes;
  const auto found = attributes.find(recipe_attribute);
  return found != attributes.end() && found->second == recipe;
}

}  // namespace pse::app
