// volume(file, p, grid): a stored volume looked up at a point. The host reads the file
// (volume/volume.h); here it becomes a call of an external.
#include "lower/lowering.h"

namespace pse::lower {

Typed Lowering::intrinsic_volume(std::vector<CallArgument>& arguments, const Span& span) {
  // By place: file and p or x, y, z; then the grid, which may also stand by name.
  const CallArgument* file = nullptr;
  const CallArgument* grid = nullptr;
  std::vector<ir::Value> place;
  for (CallArgument& argument : arguments) {
    if (argument.name == "grid" ||
        (argument.name.empty() && place.size() == 3 && grid == nullptr)) {
      grid = &argument;
    } else if (argument.name == "file" || (argument.name.empty() && file == nullptr)) {
      file = &argument;
    } else if ((argument.name.empty() || argument.name == "p") && place.size() < 3) {
      const Typed value = to_number(argument.value);
      const bool point = value.kind == Kind::vector && value.rows == 3 && place.empty();
      if (!point && value.kind != Kind::number) {
        error("argument-type", argument.span,
              "a place in a volume is a vector of three, this is " + describe(value));
        return {};
      }
      place.insert(place.end(), value.parts.begin(), value.parts.end());
    } else {
      error("unknown-argument", argument.span, "`volume` takes (file, p, grid)");
      return {};
    }
  }
  if (file == nullptr || place.size() != 3) {
    error("argument-count", span, "`volume` needs the name of a file and a point",
          "volume(\"cloud.vdb\", point)");
    return {};
  }
  for (const CallArgument* text : {file, grid}) {
    if (text == nullptr || text->value.kind == Kind::text) continue;
    error("argument-type", text->span,
          std::string(text == file ? "the file" : "the grid") + " of `volume` is a text, this is " +
              describe(text->value));
    return {};
  }

  // One external per file and grid.
  const std::string grid_name = grid == nullptr ? "" : grid->value.text;
  std::string problem = "volumes cannot be read here";
  const int components =
      host_.volume_components
          ? host_.volume_components(file->value.text, grid_name, problem)
          : 0;
  if (components <= 0) {
    error("volume", file->span, problem);
    return {};
  }
  const std::string name = "volume " + std::to_string(grid_name.size()) + " " + grid_name + " " +
                           file->value.text;
  std::size_t index = 0;
  while (index < module_.externals.size() && module_.externals[index].name != name) ++index;
  if (index == module_.externals.size()) module_.externals.push_back({name, 3, components});
  const std::vector<ir::Type> types(static_cast<std::size_t>(components), ir::Type::f32);
  const auto results = builder_->emit_multi(ir::Op::external, place, types,
                                            static_cast<std::int32_t>(index));
  return components == 1 ? number(results.front()) : vector(results);
}

}  // namespace pse::lower
