// Builtins whose meaning depends on the shapes of their arguments, so that no program could say
// them.
#include <fmt/format.h>

#include <limits>

#include "lower/lowering.h"

namespace pse::lower {

namespace {

constexpr const char* names[] = {"transpose",    "count",    "size",    "min",     "max",
                                 "select",       "any",      "all",     "array",   "texture",
                                 "texture_size", "volume",   "number",  "vector",  "identity",
                                 "isnan",        "isfinite", "Dx",      "Dy",      "filterwidth",
                                 "trace",        "radiance", "visible", "require", "expect"};

}  // namespace

bool Lowering::is_intrinsic(const std::string& name) const {
  for (const char* known_name : names)
    if (name == known_name) return true;
  return false;
}

std::vector<std::string> Lowering::intrinsic_names() const {
  return {std::begin(names), std::end(names)};
}

// min, max, any, all: over the arguments component by component, or over one vector's components.
Typed Lowering::intrinsic_fold(const std::string& name, std::vector<CallArgument>& arguments,
                               const Span& span) {
  if (arguments.empty()) {
    error("argument-count", span, "`" + name + "` needs at least one argument");
    return {};
  }
  const auto fold = [&](ir::Value a, ir::Value b) {
    if (name == "min") return emit(ir::Op::fmin, {a, b});
    if (name == "max") return emit(ir::Op::fmax, {a, b});
    return emit(name == "all" ? ir::Op::band : ir::Op::bor, {a, b});
  };
  const bool logical = name == "any" || name == "all";
  for (CallArgument& argument : arguments) {
    argument.value = to_number(argument.value);
    if (!argument.value.is_numeric()) {
      error("argument-type", argument.span,
            "`" + name + "` works on numbers and vectors, this is " + describe(argument.value));
      return {};
    }
    if (logical)
      for (ir::Value& part : argument.value.parts) part = emit(ir::Op::fne, {part, constant(0)});
  }
  if (arguments.size() == 1 || logical) {
    // Everything into one number.
    ir::Value result = ir::no_value;
    for (const CallArgument& argument : arguments)
      for (const ir::Value part : argument.value.parts)
        result = result == ir::no_value ? part : fold(result, part);
    return logical ? truth(result) : number(result);
  }
  Typed result = arguments.front().value;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const Typed& next = arguments[i].value;
    const auto shape = common_shape(result, next);
    if (!shape) {
      error("argument-type", arguments[i].span,
            "`" + name + "` is given " + describe(result) + " and " + describe(next),
            "vectors in one call must have the same length");
      return {};
    }
    const Typed a = promote(result, *shape), b = promote(next, *shape);
    result = *shape;
    for (std::size_t c = 0; c < result.parts.size(); ++c)
      result.parts[c] = fold(a.parts[c], b.parts[c]);
  }
  return result;
}

Typed Lowering::intrinsic_texture(std::vector<CallArgument>& arguments, const Span& span) {
  // texture(file, u, v, layer, filter, wrap, width): the first three by place, the others by name
  // or place.
  const char* const order[] = {"file", "u", "v", "layer", "filter", "wrap", "width"};
  std::map<std::string, CallArgument*> given;
  std::size_t place = 0;
  for (CallArgument& argument : arguments) {
    std::string name = argument.name;
    if (name.empty()) {
      // texture(file, [u v]) is the same as texture(file, u, v).
      if (place == 1 && argument.value.kind == Kind::vector && argument.value.rows == 2) {
        given["uv"] = &argument;
        place = 3;
        continue;
      }
      name = place < std::size(order) ? order[place] : "";
      ++place;
    }
    bool known_name = false;
    for (const char* candidate : order) known_name = known_name || name == candidate;
    if (!known_name) {
      error("unknown-argument", argument.span,
            "`texture` takes (file, u, v, layer, filter, wrap, width)");
      return {};
    }
    given[name] = &argument;
  }
  const auto text = [&](const char* name, const char* otherwise,
                        std::initializer_list<const char*> allowed) {
    if (!given.contains(name)) return std::string(otherwise);
    const Typed& value = given[name]->value;
    bool fits = value.kind == Kind::text && (allowed.size() == 0 || value.text == otherwise);
    for (const char* candidate : allowed)
      fits = fits || (value.kind == Kind::text && value.text == candidate);
    if (!fits) {
      std::string list;
      for (const char* candidate : allowed)
        list += (list.empty() ? "" : ", ") + ("\"" + std::string(candidate) + "\"");
      error("argument-type", given[name]->span,
            std::string("`") + name + "` of `texture` is a text" +
                (list.empty() ? "" : ": one of " + list));
      return std::string("?");
    }
    return value.text;
  };
  if (!given.contains("file")) {
    error("argument-count", span, "`texture` needs the name of an image file",
          "texture(\"wood.exr\", u, v)");
    return {};
  }
  const std::string file = text("file", "", {});
  const std::string layer = text("layer", "color", {});
  const std::string filter = text("filter", "linear", {"nearest", "linear", "cubic", "mipmap"});
  const std::string wrap = text("wrap", "repeat", {"repeat", "clamp", "mirror", "black"});
  if (file == "?" || layer == "?" || filter == "?" || wrap == "?") return {};

  // The coordinates and the filter's width.
  std::vector<ir::Value> operands;
  if (given.contains("uv")) operands = given["uv"]->value.parts;
  for (const char* name : {"u", "v"}) {
    if (given.contains("uv")) break;
    if (!given.contains(name)) {
      error("argument-count", span, "`texture` needs the coordinates u and v");
      return {};
    }
    const Typed value = to_number(given[name]->value);
    if (value.kind != Kind::number) {
      error("argument-type", given[name]->span,
            "a coordinate is a number, this is " + describe(value));
      return {};
    }
    operands.push_back(value.parts.front());
  }
  const Typed width = given.contains("width") ? to_number(given["width"]->value) : number(0.0f);
  if (width.kind != Kind::number) {
    error("argument-type", given["width"]->span, "`width` is a number, this is " + describe(width));
    return {};
  }
  operands.push_back(width.parts.front());
  if (given.contains("width") && filter != "mipmap")
    warning("unused-width", given["width"]->span,
            "`width` is of use to the filter \"mipmap\" only, not to \"" + filter + "\"",
            "add filter=\"mipmap\", or leave the width out");

  std::string problem = "images cannot be read here";
  const int components =
      host_.texture_components ? host_.texture_components(file, layer, problem) : 0;
  if (components <= 0) {
    error("texture", given["file"]->span, problem);
    return {};
  }
  const std::string name = "texture " + layer + " " + filter + " " + wrap + " " + file;
  std::size_t index = 0;
  while (index < module_.externals.size() && module_.externals[index].name != name) ++index;
  if (index == module_.externals.size()) module_.externals.push_back({name, 3, components});
  const std::vector<ir::Type> types(static_cast<std::size_t>(components), ir::Type::f32);
  const auto results =
      builder_->emit_multi(ir::Op::external, operands, types, static_cast<std::int32_t>(index));
  return components == 1 ? number(results.front()) : vector(results);
}

// [width height] of an image file, known while compiling.
Typed Lowering::intrinsic_texture_size(const std::vector<CallArgument>& arguments) {
  const CallArgument& file = arguments.front();
  const bool named = file.value.kind == Kind::text;
  std::string problem = named ? "images cannot be read here"
                              : "`texture_size` takes the name of an image file";
  std::pair<int, int> size;
  if (named && host_.texture_size)
    size = host_.texture_size(file.value.text, problem);
  if (size.first > 0)
    return vector(
        {constant(static_cast<float>(size.first)), constant(static_cast<float>(size.second))});
  error(named ? "texture" : "argument-type", file.span, problem);
  return {};
}

// How much each component changes from pixel to pixel: along a row, along a column, and the larger
// change in any direction.
Typed Lowering::slopes(const std::string& name, Typed value) {
  for (ir::Value& part : value.parts) {
    const auto along = [&](std::int32_t axis) { return emit(ir::Op::slope, {part}, axis); };
    if (name != "filterwidth") {
      part = along(name == "Dx" ? 0 : 1);
      continue;
    }
    const ir::Value x = along(0), y = along(1);
    part = emit(ir::Op::fsqrt, {emit(ir::Op::fma, {x, x, emit(ir::Op::fmul, {y, y})})});
  }
  return value;
}

Typed Lowering::call_intrinsic(const std::string& name, std::vector<CallArgument>& arguments,
                               const Span& span) {
  if (name == "texture") return intrinsic_texture(arguments, span);
  if (name == "volume") return intrinsic_volume(arguments, span);
  if (is_scene_call(name)) return intrinsic_scene(name, arguments, span);
  if (name == "expect") return intrinsic_expect(arguments, span);
  if (name == "min" || name == "max" || name == "any" || name == "all")
    return intrinsic_fold(name, arguments, span);
  const auto needs = [&](std::size_t count) {
    if (arguments.size() == count) return true;
    error("argument-count", span,
          "`" + name + "` takes " + std::to_string(count) + " argument" + (count == 1 ? "" : "s") +
              ", this gives " + std::to_string(arguments.size()));
    return false;
  };
  if (name == "texture_size") return needs(1) ? intrinsic_texture_size(arguments) : Typed{};
  const auto refuse = [&](const char* what) {
    const Typed& given = arguments.front().value;
    const auto constant = given.kind == Kind::number ? known(given.parts.front()) : std::nullopt;
    error("argument-type", arguments.front().span,
          "`" + name + "` needs " + what + ", this is " +
              (constant ? fmt::format("{}", *constant) : describe(given)));
    return Typed{};
  };
  if (name == "require") return needs(2) ? intrinsic_require(arguments, span) : Typed{};
  if (name == "select") {
    if (!needs(3)) return {};
    const Typed condition = to_truth(arguments[0].value, arguments[0].span);
    if (condition.is_error()) return {};
    const auto shape = common_shape(arguments[1].value, arguments[2].value);
    if (!shape) {
      error("argument-type", span, "`select` is given " + describe(arguments[1].value) + " and " +
                                       describe(arguments[2].value));
      return {};
    }
    const Typed a = promote(arguments[1].value, *shape), b = promote(arguments[2].value, *shape);
    Typed result = *shape;
    for (std::size_t i = 0; i < result.parts.size(); ++i)
      result.parts[i] = emit(ir::Op::select, {condition.parts.front(), a.parts[i], b.parts[i]});
    return result;
  }
  if (name == "array") {
    if (!needs(1)) return {};
    const auto capacity = arguments[0].value.kind == Kind::number
                              ? known(arguments[0].value.parts.front())
                              : std::nullopt;
    if (!capacity || !(*capacity >= 1 && *capacity <= 1048576))
      return refuse("a constant from 1 to 1048576");
    return new_array("array", static_cast<std::int32_t>(*capacity));
  }
  if (!needs(1)) return {};
  const Typed value = to_number(arguments.front().value);
  if (name == "count" || name == "size") {
    if (value.kind == Kind::array) return array_length(value);
    if (value.is_numeric()) return number(static_cast<float>(value.rows));
    return refuse("an array or a vector");
  }
  if (!value.is_numeric()) return refuse("a number or a vector");
  if (name == "isnan" || name == "isfinite") {
    ir::Value result = ir::no_value;
    for (const ir::Value part : value.parts) {
      const ir::Value here =
          name == "isnan" ? emit(ir::Op::fne, {part, part})
                          : emit(ir::Op::flt, {emit(ir::Op::fabs, {part}),
                                               constant(std::numeric_limits<float>::infinity())});
      result = result == ir::no_value
                   ? here
                   : emit(name == "isnan" ? ir::Op::bor : ir::Op::band, {result, here});
    }
    return truth(result);
  }
  if (name == "Dx" || name == "Dy" || name == "filterwidth") return slopes(name, value);
  if (name == "number")
    return value.kind == Kind::number ? value : refuse("a number or a truth value");
  if (name == "vector") return vector(value.parts);
  if (name == "transpose") {
    if (value.kind != Kind::matrix) return refuse("a matrix");
    Typed result = value;
    std::swap(result.rows, result.columns);
    for (int r = 0; r < value.rows; ++r)
      for (int c = 0; c < value.columns; ++c)
        result.parts[static_cast<std::size_t>(c * value.rows + r)] =
            value.parts[static_cast<std::size_t>(r * value.columns + c)];
    return result;
  }
  if (name == "identity") {
    const auto size = value.kind == Kind::number ? known(value.parts.front()) : std::nullopt;
    if (!size || !(*size >= 1 && *size <= 16)) return refuse("a constant from 1 to 16");
    Typed result{.kind = Kind::matrix, .parts = {}, .text = {}, .function = {}};
    result.rows = result.columns = static_cast<int>(*size);
    for (int r = 0; r < result.rows; ++r)
      for (int c = 0; c < result.rows; ++c) result.parts.push_back(constant(r == c ? 1.0f : 0.0f));
    return result;
  }
  error("unknown-function", span, "`" + name + "` is not known here");
  return {};
}

}  // namespace pse::lower
