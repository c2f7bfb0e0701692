// Calls: a function of the language is lowered into its caller for the types it is called with.
#include <algorithm>

#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

Typed Lowering::lower_call(const CallExpr& call, const Span& span) {
  // The callee: a function by name, a variable that holds one, or one of a named module.
  std::string name;
  std::optional<FunctionRef> function;
  bool passed = false;  // the caller passed it in
  if (const auto* callee = std::get_if<NameExpr>(&call.callee->node)) {
    name = callee->name;
    auto bound = call_->variables.find(name);
    bool is_bound = bound != call_->variables.end();
    if (!is_bound && call_ != &top_ && call_->scope == &main_) {
      bound = top_.variables.find(name);
      is_bound = bound != top_.variables.end();
    }
    // A name may be both a value and a function (`fire = fire(p)`): a value cannot be called, so
    // the function is meant.
    if (is_bound && bound->second.kind == Kind::function) {
      function = bound->second.function;
      passed = true;
    } else if (!(is_bound && bound->second.is_error()))
      function = find_function(name, call_->scope);
    if (!function && is_bound) {
      if (!bound->second.is_error())
        error("not-a-function", call.callee->span,
              "`" + name + "` is " + describe(bound->second) + ", not a function");
      for (const Argument& argument : call.arguments) lower(*argument.value);
      return {};
    }
  } else {
    const Typed called = lower(*call.callee);
    if (called.kind == Kind::function) {
      function = called.function;
      if (const auto* member = std::get_if<MemberExpr>(&call.callee->node)) name = member->name;
    } else {
      if (!called.is_error())
        error("not-a-function", call.callee->span, describe(called) + " cannot be called");
      return {};
    }
  }
  if (!function) {
    const std::string foreign = foreign_function(name);
    error("unknown-function", call.callee->span, "there is no function `" + name + "`",
          foreign.empty() ? did_you_mean(name, callable_names()) : foreign);
    for (const Argument& argument : call.arguments) lower(*argument.value);
    return {};
  }

  std::vector<CallArgument> arguments;
  bool failed = false;
  for (const Argument& argument : call.arguments) {
    arguments.push_back({argument.name, argument.value->span, lower(*argument.value)});
    failed = failed || arguments.back().value.is_error();
    if (arguments.back().value.kind == Kind::nothing) {
      const auto* inner = std::get_if<CallExpr>(&argument.value->node);
      const auto* callee = inner ? std::get_if<NameExpr>(&inner->callee->node) : nullptr;
      error("no-value", argument.value->span,
            callee ? "`" + callee->name + "` returns no value" : "this argument has no value");
      failed = true;
    }
  }
  if (failed) return {};
  // A function that was passed to the library, or into another file, takes of what it is called
  // with there as much as it asks for, so that a marcher may offer point, normal and eye to a
  // colour that needs only the point.
  const bool offered =
      function->scope != call_->scope || library_texts_.contains(call_->scope->file);
  if (passed && function->definition && offered) {
    std::size_t room = function->definition->parameters.size();
    std::erase_if(arguments, [&](const CallArgument& argument) {
      return argument.name.empty() && (room == 0 || room-- == 0);
    });
  }
  builder_->set_span(span);
  Typed result = call_function(*function, std::move(arguments), span, name);
  // What the library takes as a density is one number, or true or false.
  const bool usable =
      result.is_error() || result.kind == Kind::number || result.kind == Kind::boolean;
  if (passed && function->definition && offered && name == "density" && !usable) {
    const FunctionStmt& given = *function->definition;
    const bool known_bad = std::ranges::any_of(diagnostics_->all(), [&](const Diagnostic& earlier) {
      return earlier.severity == Severity::error && earlier.span == given.name_span;
    });
    // Asked for at many places of the library, it is wrong once.
    if (known_bad) return {};
    error("density", given.name_span,
          "`" + given.name + "` is used as a density and has to return one number, " +
              (result.kind == Kind::nothing ? "it returns nothing"
                                            : "it returns " + describe(result)),
          "0 where space is empty, 1 where it is solid, what is between where it is thin");
    return {};
  }
  return result;
}

Typed Lowering::call_function(const FunctionRef& function, std::vector<CallArgument> arguments,
                              const Span& span, const std::string& name) {
  if (function.definition) return call_user(function, arguments, span);
  if (is_intrinsic(function.builtin)) return call_intrinsic(function.builtin, arguments, span);
  return call_builtin(function.builtin.empty() ? name : function.builtin, arguments, span);
}

Typed Lowering::call_user(const FunctionRef& function, std::vector<CallArgument>& arguments,
                          const Span& span) {
  const FunctionStmt& definition = *function.definition;

  // No recursion: a function is lowered into its caller, so it cannot be its own caller. With
  // another function as its argument it is another function: smooth(f, p) may be called inside an f
  // that is itself smoothed.
  std::vector<Typed> functions;
  for (const CallArgument& argument : arguments)
    if (argument.value.kind == Kind::function) functions.push_back(argument.value);
  int calls = 0;
  for (const Call* call = call_; call; call = call->caller) {
    ++calls;
    if (call->definition == &definition &&
        std::equal(functions.begin(), functions.end(), call->functions.begin(),
                   call->functions.end(), same_shape)) {
      error("recursion", span,
            "`" + definition.name + "` calls itself" +
                (call == call_ ? std::string() : " through `" + call_->definition->name + "`"),
            "functions cannot be recursive; use a loop");
      return {};
    }
  }
  if (calls > 64) {
    error("too-deep", span, "calls are nested more than 64 deep");
    return {};
  }

  // Bind arguments to parameters: by place, by name, by default.
  Call inner;
  inner.definition = &definition;
  inner.scope = function.scope;
  inner.body = &definition.body;
  inner.caller = call_;
  inner.call_span = span;
  inner.arguments = &arguments;
  inner.functions = std::move(functions);
  std::size_t place = 0;
  for (CallArgument& argument : arguments) {
    std::string parameter = argument.name;
    if (parameter.empty()) {
      if (place >= definition.parameters.size()) {
        error("argument-count", argument.span,
              "`" + definition.name + "` takes " + std::to_string(definition.parameters.size()) +
                  " argument" + (definition.parameters.size() == 1 ? "" : "s") +
                  ", this is one more");
        return {};
      }
      parameter = definition.parameters[place++].name;
    } else {
      std::vector<std::string> names;
      bool exists = false;
      for (const Parameter& p : definition.parameters) {
        names.push_back(p.name);
        exists = exists || p.name == parameter;
      }
      if (!exists) {
        error("unknown-argument", argument.span,
              "`" + definition.name + "` has no parameter `" + parameter + "`",
              did_you_mean(parameter, names));
        return {};
      }
    }
    if (!inner.variables.emplace(parameter, argument.value).second) {
      // Two parameters of one name have been reported.
      if (std::ranges::count(definition.parameters, parameter, &Parameter::name) == 1)
        error("argument-twice", argument.span, "parameter `" + parameter + "` is given twice");
      return {};
    }
  }
  call_ = &inner;
  const auto first = static_cast<ir::Value>(builder_->function().values.size());
  const int outer_loops = std::exchange(loop_depth_, 0);
  Typed result{.kind = Kind::nothing, .parts = {}, .text = {}, .function = {}};
  const auto leave = [&] {
    call_ = inner.caller;
    loop_depth_ = outer_loops;
  };
  try {
    for (const Parameter& parameter : definition.parameters) {
      if (inner.variables.contains(parameter.name)) continue;
      if (!parameter.default_value) {
        leave();
        error("argument-count", span,
              "`" + definition.name + "` needs a value for `" + parameter.name + "`");
        return {};
      }
      inner.variables[parameter.name] = lower(*parameter.default_value);
    }
    bind_arrays(definition.body);
    lower_block(definition.body);
  } catch (...) {
    leave();
    throw;
  }
  if (const auto found = inner.variables.find("%result"); found != inner.variables.end())
    result = found->second;
  const auto callee = static_cast<std::uint32_t>(callees_.size());
  const auto end = static_cast<ir::Value>(builder_->function().values.size());
  ranges_.push_back({callees_.try_emplace(&definition, callee).first->second, first, end});
  leave();
  return result;
}

Typed Lowering::call_builtin(const std::string& name, std::vector<CallArgument>& arguments,
                             const Span& span) {
  // Shapes become component lists, positional and by name.
  BuiltinCall call{.name = name, .arguments = {}, .named = {}};
  Typed longest = number(ir::no_value);
  for (CallArgument& argument : arguments) {
    argument.value = to_number(argument.value);
    if (!argument.value.is_numeric()) {
      error("argument-type", argument.span,
            "`" + name + "` works on numbers and vectors, this is " + describe(argument.value));
      return {};
    }
    if (argument.value.components() > longest.components()) longest = argument.value;
    if (argument.name.empty())
      call.arguments.push_back(argument.value.parts);
    else
      call.named.emplace_back(argument.name, argument.value.parts);
  }
  if (const Builtin* builtin = find_builtin(name)) {
    const std::vector<std::string> parameters = parameter_names(*builtin);
    for (const CallArgument& argument : arguments)
      if (!argument.name.empty() &&
          std::ranges::find(parameters, argument.name) == parameters.end()) {
        error("unknown-argument", argument.span,
              "`" + name + "` has no parameter `" + argument.name + "`",
              did_you_mean(argument.name, parameters));
        return {};
      }
  }
  const auto results = builtins_->emit(*builder_, call);
  if (!results) {
    error("argument-type", span, results.error());
    return {};
  }
  if (results->size() == 1) return number(results->front());

  // Component-wise results keep the shape of their argument, so that sqrt of a matrix is a matrix.
  if (longest.kind == Kind::matrix && find_builtin(name)->result == ResultShape::elementwise) {
    Typed result = longest;
    result.parts = *results;
    return result;
  }
  return vector(*results);
}

}  // namespace pse::lower
