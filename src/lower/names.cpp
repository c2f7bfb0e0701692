// What a name means: a variable, a constant, something the stream brings, a function; and what was
// meant when none.
#include "lower/constant.h"
#include "lower/library.h"
#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

Typed Lowering::lower_name(const std::string& name, const Span& span) {
  // The call's own variables, then the program's.
  if (const auto found = call_->variables.find(name); found != call_->variables.end())
    return found->second;
  if (call_ != &top_ && call_->scope == &main_)
    if (const auto found = top_.variables.find(name); found != top_.variables.end())
      return found->second;

  // A file's own function is meant where the stream happens to bring something of its name.
  if (const auto own = call_->scope->functions.find(name); own != call_->scope->functions.end())
    return {.kind = Kind::function,
            .parts = {},
            .text = {},
            .function = {own->second, call_->scope, {}}};
  if (const StreamName* stream = stream_name(name)) return read_stream(*stream);
  bool found = false;
  if (const Typed value = lower_module_constant(call_->scope, name, span, found); found)
    return value;
  if (const auto value = named_constant(name)) return number(*value);
  if (const auto rgb = named_colour(name))
    return vector({constant((*rgb)[0]), constant((*rgb)[1]), constant((*rgb)[2])});
  if (name == "begin_frame") return truth(builder_->const_bool(true));
  if (const auto function = find_function(name, call_->scope))
    return {.kind = Kind::function, .parts = {}, .text = {}, .function = *function};

  std::string hint;
  for (const StreamName& brought : options_.stream)
    if (hint.empty() && brought.name.ends_with("." + name))
      hint = "an image brings `" + brought.name + "`";
  if (hint.empty()) hint = source_of(name);
  if (hint.empty() && ever_set_at_top_.contains(name))
    hint = "it is set further down, or for the turns of a loop alone; set it before it is read";
  if (hint.empty()) hint = did_you_mean(name, visible_names());
  if (hint.empty()) {
    std::string names;
    for (const StreamName& brought : options_.stream) {
      if (brought.name.find('.') != std::string::npos || names.size() > 120) continue;
      names += (names.empty() ? "" : ", ") + brought.name;
    }
    if (!names.empty()) hint = "the stream brings " + names;
  }
  error("unknown-name", span, "`" + name + "` is not set here, and the stream does not bring it",
        hint);
  return {};
}

std::optional<FunctionRef> Lowering::find_function(const std::string& name, ModuleScope* scope) {
  // The file's own functions, those it imports, the builtins, the library.
  const auto in = [&](ModuleScope* module) -> std::optional<FunctionRef> {
    if (const auto found = module->functions.find(name); found != module->functions.end())
      return FunctionRef{found->second, module, {}};
    return {};
  };
  if (const auto own = in(scope)) return own;
  for (ModuleScope* import : scope->open_imports)
    if (const auto imported = in(import)) return imported;
  if (is_intrinsic(name) || find_builtin(name)) return FunctionRef{nullptr, nullptr, name};
  if (ModuleScope* module = library_module_of(name))
    if (const auto found = in(module)) return found;
  return {};
}

Typed Lowering::lower_module_constant(ModuleScope* scope, const std::string& name, const Span& span,
                                      bool& found) {
  const auto in = [&](ModuleScope* module) -> const Expr* {
    const auto constant = module->constants.find(name);
    return constant == module->constants.end() ? nullptr : constant->second;
  };
  ModuleScope* home = scope;
  const Expr* value = in(scope);
  for (ModuleScope* import : scope->open_imports) {
    if (value) break;
    value = in(import);
    home = import;
  }
  if (!value) return {};
  found = true;
  if (const auto knob = home->knobs.find(name); knob != home->knobs.end())
    return read_knob(knob->second);

  // A module's constants are computed where they are read, in the module's own scope.
  for (const Call* call = call_; call; call = call->caller)
    if (call->body == nullptr && call->call_span == value->span) {
      error("recursion", span, "`" + name + "` is defined by itself");
      return {};
    }
  Call inner;
  inner.scope = home;
  inner.caller = call_;
  inner.call_span = value->span;
  call_ = &inner;
  Typed result;
  try {
    result = lower(*value);
  } catch (...) {
    call_ = inner.caller;
    throw;
  }
  call_ = inner.caller;
  return result;
}

std::vector<std::string> Lowering::visible_names() const {
  std::vector<std::string> names = named_constants();
  for (const auto& [name, value] : call_->variables)
    if (name.front() != '%') names.push_back(name);
  for (const auto& [name, value] : top_.variables)
    if (name.front() != '%') names.push_back(name);
  for (const StreamName& stream : options_.stream) names.push_back(stream.name);
  for (const std::string& name : named_colours()) names.push_back(name);
  for (const std::string& name : callable_names()) names.push_back(name);
  return names;
}

std::vector<std::string> Lowering::callable_names() const {
  std::vector<std::string> names;
  for (const Builtin& builtin : builtins()) names.emplace_back(builtin.name);
  for (const std::string& name : intrinsic_names()) names.push_back(name);
  for (const auto& [name, file] : library_index_) names.push_back(name);
  for (const auto& [name, function] : call_->scope->functions) names.push_back(name);
  for (const ModuleScope* import : call_->scope->open_imports)
    for (const auto& [name, function] : import->functions) names.push_back(name);
  return names;
}

// What functions of other languages are called here.
std::string Lowering::foreign_function(const std::string& name) {
  constexpr std::pair<const char*, const char*> foreign[] = {
      {"vec2", "write a vector as `[a b]`"},
      {"vec3", "write a vector as `[a b c]`"},
      {"vec4", "write a vector as `[a b c d]`"},
      {"float2", "write a vector as `[a b]`"},
      {"float3", "write a vector as `[a b c]`"},
      {"float4", "write a vector as `[a b c d]`"},
      {"rgb", "write a colour as `[r g b]`"},
      {"rgba", "write a colour as `[r g b a]`"},
      {"vector", "write a vector as `[a b c]`"},
      {"fabs", "write `abs`"},
      {"mod", "write `a % b`"},
      {"fmod", "write `a % b`"},
      {"frac", "write `fract`"},
      {"fit", "write `remap(t, a0, a1, b0, b1)`"},
      {"inversesqrt", "write `1 / sqrt(x)`"},
      {"rsqrt", "write `1 / sqrt(x)`"},
      {"rand", "write `hash(...)`"},
      {"random", "write `hash(...)`"},
      {"texture2D", "write `texture(file, u, v)`"},
      {"float", "leave it out: all numbers are floats"},
      {"int", "write `floor` or `trunc`"},
      {"mag", "write `norm` or `length`"},
      {"sqr", "write `x ^ 2`"},
      {"len", "write `count`"},
      {"size", "write `count`"},
      {"print", "set a name: it becomes a layer of the picture"},
      {"printf", "set a name: it becomes a layer of the picture"},
  };
  for (const auto& [theirs, ours] : foreign)
    if (name == theirs) return ours;
  return {};
}

// Which source of samples brings a name that this one lacks.
std::string Lowering::source_of(const std::string& name) const {
  // An image that shows surfaces, or nearly so.
  const bool has_normal = stream_name("normal") != nullptr;
  if (has_normal && (name == "view" || name == "direction" || name == "eye"))
    return "an image of surfaces brings `" + name +
           "` where its eye is known: --camera eye=X,Y,Z";
  const auto brings = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const char* one) { return stream_name(one) != nullptr; });
  };
  if (!has_normal && brings({"N", "Normal"}))
    return "an image is one of surfaces where it has a position too: a layer `P` or `Position`";
  if (name == "normal" && brings({"P", "Position", "place"}))
    return "an image is one of surfaces where it has a normal too: a layer `N` or `Normal`";
  for (const char* of_surfaces : {"normal", "place", "uv", "id", "depth", "view", "hit", "backface",
                                  "flat_normal", "light_direction", "light_color"})
    if (name == of_surfaces)
      return "visible surfaces bring `" + name + "`: render with --on sphere, or a scene";
  for (const char* of_images : {"color", "alpha", "Z"})
    if (name == of_images)
      return "an image without a name brings `" + name + "`: pse render PROGRAM IMAGE -o FILE";
  return {};
}

std::string Lowering::did_you_mean(const std::string& name,
                                   const std::vector<std::string>& candidates) const {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : "did you mean `" + nearest + "`?";
}

}  // namespace pse::lower
