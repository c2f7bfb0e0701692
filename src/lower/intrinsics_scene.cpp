// trace(), radiance() and visible(): rays that a program sends into the scene it is rendered in.
// They are externals (ir::Op::external) that the host binds; surface/trace_call.h answers them.
// What trace() gives is a vector of 14 numbers whose parts have names.
#include <array>

#include "lower/lowering.h"

namespace pse::lower {
namespace {

struct HitPart {
  const char* name;
  std::size_t first;
  std::size_t count;
};
// In the order of surface/trace_call.h.
constexpr std::array<HitPart, 7> hit_parts = {{{"distance", 0, 1},
                                               {"place", 1, 3},
                                               {"point", 4, 3},
                                               {"normal", 7, 3},
                                               {"uv", 10, 2},
                                               {"id", 12, 1},
                                               {"backface", 13, 1}}};
constexpr std::size_t hit_size = 14;

}  // namespace

bool Lowering::is_scene_call(const std::string& name) {
  return name == "trace" || name == "radiance" || name == "visible";
}

Typed Lowering::intrinsic_scene(const std::string& name, std::vector<CallArgument>& arguments,
                                const Span& span) {
  const bool between = name == "visible";
  const char* const usage = between ? "visible(place, other_place)" : "(origin, direction)";
  if (arguments.size() != 2) {
    error("argument-count", span,
          "`" + name + "` takes 2 arguments, this gives " + std::to_string(arguments.size()),
          usage);
    return {};
  }
  std::vector<ir::Value> operands;
  for (const CallArgument& argument : arguments) {
    const Typed value = to_number(argument.value);
    if (value.is_error()) return {};
    if (!argument.name.empty() && argument.name != "origin" && argument.name != "direction") {
      error("unknown-argument", argument.span, "`" + name + "` takes " + usage);
      return {};
    }
    if (value.kind != Kind::vector || value.rows != 3) {
      error("argument-type", argument.span,
            "`" + name + "` takes two vectors of 3, this is " + describe(value), usage);
      return {};
    }
    operands.insert(operands.end(), value.parts.begin(), value.parts.end());
  }
  // Something of every sample among the arguments: the scene is there for samples only.
  const StreamName* column = stream_name("px");
  if (column == nullptr) {
    error("no-scene", span, "`" + name + "` works in pictures only");
    return {};
  }
  operands.push_back(read_stream(*column).parts.front());

  const int results = name == "trace" ? static_cast<int>(hit_size) : name == "radiance" ? 4 : 1;
  std::size_t index = 0;
  while (index < module_.externals.size() && module_.externals[index].name != name) ++index;
  if (index == module_.externals.size())
    module_.externals.push_back({name, static_cast<int>(operands.size()), results});
  const std::vector<ir::Type> types(static_cast<std::size_t>(results), ir::Type::f32);
  const auto values = builder_->emit_multi(ir::Op::external, operands, types,
                                           static_cast<std::int32_t>(index));
  return results == 1 ? number(values.front()) : vector(values);
}

std::optional<Typed> Lowering::hit_part(const Typed& base, const std::string& name) {
  if (base.kind != Kind::vector || base.parts.size() != hit_size) return {};
  for (const HitPart& part : hit_parts)
    if (name == part.name) {
      const auto begin = base.parts.begin() + static_cast<std::ptrdiff_t>(part.first);
      if (part.count == 1) return number(*begin);
      return vector({begin, begin + static_cast<std::ptrdiff_t>(part.count)});
    }
  return {};
}

}  // namespace pse::lower
