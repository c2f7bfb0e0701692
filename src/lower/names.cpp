// What a name means: a variable, a constant, something the stream brings, a function; and what was meant when none.
#include "lower/constant.h"
#include "lower/library.h"
#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

namespace {

// Colours by name, linear Rec. 709.
struct NamedColour {
  const char* name;
  float rgb[3];
};
constexpr NamedColour colours[] = {
    {"white", {1, 1, 1}}, {"black", {0, 0, 0}},  {"red", {1, 0, 0}},     {"green", {0, 1, 0}},
    {"blue", {0, 0, 1}},  {"cyan", {0, 1, 1}},   {"magenta", {1, 0, 1}}, {"yellow", {1, 1, 0}},
    {"gray", {0.18f, 0.18f, 0.18f}}, {"grey", {0.18f, 0.18f, 0.18f}},
};

}  // namespace

Typed Lowering::lower_name(const std::string& name, const Span& span) {
  // The call's own variables, then the program's.
  if (const auto found = call_->variables.find(name); found != call_->variables.end()) return found->second;
  if (call_ != &top_ && call_->scope == &main_)
    if (const auto found = top_.variables.find(name); found != top_.variables.end()) return found->second;

  if (const StreamName* stream = stream_name(name)) return read_stream(*stream);
  bool found = false;
  if (const Typed value = lower_module_constant(call_->scope, name, span, found); found) return value;
  if (const auto value = named_constant(name)) return number(*value);
  for (const NamedColour& colour : colours)
    if (name == colour.name) return vector({constant(colour.rgb[0]), constant(colour.rgb[1]), constant(colour.rgb[2])});
  if (name == "begin_frame") return truth(builder_->const_bool(true));
  if (const auto function = find_function(name, call_->scope))
    return {.kind = Kind::function, .parts = {}, .text = {}, .function = *function};

  std::string hint = did_you_mean(name, visible_names());
  if (hint.empty() && set_at_top_.contains(name)) hint = "it is set further down; set it before it is read";
  if (hint.empty()) {
    std::string names;
    for (const StreamName& brought : options_.stream) {
      if (brought.name.find('.') != std::string::npos || names.size() > 120) continue;
      names += (names.empty() ? "" : ", ") + brought.name;
    }
    if (!names.empty()) hint = "the stream brings " + names;
  }
  error("unknown-name", span, "`" + name + "` is not set here, and the stream does not bring it", hint);
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

Typed Lowering::lower_module_constant(ModuleScope* scope, const std::string& name, const Span& span, bool& found) {
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
  for (const NamedColour& colour : colours) names.emplace_back(colour.name);
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

std::string Lowering::did_you_mean(const std::string& name, const std::vector<std::string>& candidates) const {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : "did you mean `" + nearest + "`?";
}

}  // namespace pse::lower
