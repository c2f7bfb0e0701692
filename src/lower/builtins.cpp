// The table of builtins as a whole: finding entries, binding arguments to parameters, emitting
// calls.
#include "lower/builtins.h"

#include <fmt/format.h>
#include <algorithm>
#include <stdexcept>

#include "lower/builtin_table.h"

namespace pse {
namespace {

// All groups as one list, put together once.
const std::vector<BuiltinEntry>& entries() {
  static const std::vector<BuiltinEntry> list = [] {
    std::vector<BuiltinEntry> all;
    for (const auto group :
         {math_builtins(), vector_builtins(), noise_builtins(), random_builtins()}) {
      all.insert(all.end(), group.begin(), group.end());
    }
    return all;
  }();
  return list;
}

const BuiltinEntry* find_entry(std::string_view name) {
  const auto& all = entries();
  const auto found =
      std::ranges::find(all, name, [](const BuiltinEntry& e) { return e.builtin.name; });
  if (found == all.end()) return nullptr;
  // Another name stands for the entry that it is the same as.
  return found->builtin.same_as.empty() ? &*found : find_entry(found->builtin.same_as);
}

struct Parameter {
  std::string_view name;
  bool optional = false;  // has a default
  bool many = false;      // takes all arguments from here on
};

// Reads "p..., period = 256".
std::vector<Parameter> parameters_of(std::string_view text) {
  std::vector<Parameter> list;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    std::string_view part = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    part.remove_prefix(std::min(part.find_first_not_of(' '), part.size()));
    Parameter parameter{part.substr(0, part.find_first_of(" =.")), part.contains('='),
                        part.contains("...")};
    list.push_back(parameter);
  }
  return list;
}

std::string usage(const Builtin& builtin) {
  return fmt::format("{}({})", builtin.name, builtin.parameters);
}

// Puts each argument at its parameter.
std::expected<BoundCall, std::string> bind(const Builtin& builtin, const BuiltinCall& call) {
  const std::vector<Parameter> parameters = parameters_of(builtin.parameters);
  BoundCall bound{builtin.name, std::vector<Components>(parameters.size())};
  std::vector<bool> given(parameters.size());

  // By position: a parameter that takes many leaves one argument for each required parameter after
  // it.
  std::size_t next = 0;
  for (std::size_t p = 0; p < parameters.size() && next < call.arguments.size(); ++p) {
    std::size_t take = 1;
    if (parameters[p].many) {
      const auto required = static_cast<std::size_t>(std::count_if(
          parameters.begin() + static_cast<std::ptrdiff_t>(p) + 1, parameters.end(),
          [&](const Parameter& q) {
            return !q.optional && std::ranges::none_of(
                                      call.named, [&](const auto& n) { return n.first == q.name; });
          }));
      const std::size_t left = call.arguments.size() - next;
      take = left > required ? left - required : 1;
    } else if (std::ranges::any_of(parameters, &Parameter::many) && parameters[p].optional) {
      break;  // after `name...` these are given by name only
    }
    given[p] = true;
    for (std::size_t i = 0; i < take; ++i, ++next) {
      bound.arguments[p].insert(bound.arguments[p].end(), call.arguments[next].begin(),
                                call.arguments[next].end());
    }
  }
  if (next < call.arguments.size()) {
    return std::unexpected(fmt::format("too many arguments for `{}`", usage(builtin)));
  }

  // By name.
  for (const auto& [name, components] : call.named) {
    const auto found = std::ranges::find(parameters, name, &Parameter::name);
    if (found == parameters.end()) {
      return std::unexpected(fmt::format("`{}` has no parameter `{}`", usage(builtin), name));
    }
    const auto p = static_cast<std::size_t>(found - parameters.begin());
    if (given[p])
      return std::unexpected(fmt::format("`{}` is given twice to `{}`", name, builtin.name));
    given[p] = true;
    bound.arguments[p] = components;
  }
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!given[p] && !parameters[p].optional) {
      return std::unexpected(
          fmt::format("`{}` needs a value for `{}`", usage(builtin), parameters[p].name));
    }
    if (given[p] && bound.arguments[p].empty()) {
      return std::unexpected(
          fmt::format("`{}` of `{}` has no components", parameters[p].name, builtin.name));
    }
  }
  return bound;
}

// Component by component; arguments of one component are repeated.
std::expected<Components, std::string> emit_elementwise(const BuiltinScope& scope,
                                                        const BuiltinEntry& entry,
                                                        const BoundCall& bound) {
  std::size_t length = 1;
  for (const Components& argument : bound.arguments) {
    if (argument.size() == 1) continue;
    if (length != 1 && argument.size() != length) {
      return std::unexpected(
          fmt::format("`{}` takes vectors of one length, and these have {} and {} components",
                      bound.name, length, argument.size()));
    }
    length = argument.size();
  }
  Components result;
  for (std::size_t i = 0; i < length; ++i) {
    std::vector<IrFloat> arguments;
    for (const Components& argument : bound.arguments) {
      arguments.push_back(scope.number(argument[argument.size() == 1 ? 0 : i]));
    }
    if (entry.large) {
      const auto body = [&entry](std::span<const IrFloat> floats, std::span<const IrInt>) {
        return std::vector{entry.number(floats)};
      };
      result.push_back(scope.values(scope.call(bound.name, arguments, {}, body)).front());
    } else {
      const IrFloat number = entry.number(arguments);
      result.push_back(place(scope.builder(), number));
    }
  }
  return result;
}

}  // namespace

std::span<const Builtin> builtins() {
  static const std::vector<Builtin> list = [] {
    std::vector<Builtin> all;
    for (const BuiltinEntry& entry : entries()) all.push_back(entry.builtin);
    return all;
  }();
  return list;
}

std::vector<std::string> parameter_names(const Builtin& builtin) {
  std::vector<std::string> names;
  const std::string_view text =
      builtin.same_as.empty() ? builtin.parameters : find_builtin(builtin.same_as)->parameters;
  for (const Parameter& parameter : parameters_of(text)) names.emplace_back(parameter.name);
  return names;
}

const Builtin* find_builtin(std::string_view name) {
  const auto list = builtins();
  const auto found = std::ranges::find(list, name, &Builtin::name);
  return found == list.end() ? nullptr : &*found;
}

std::expected<Components, std::string> BuiltinEmitter::emit(ir::Builder& builder,
                                                            const BuiltinCall& call) {
  const BuiltinEntry* entry = find_entry(call.name);
  if (!entry) return std::unexpected(fmt::format("there is no builtin function '{}'", call.name));
  const auto bound = bind(entry->builtin, call);
  if (!bound) return std::unexpected(bound.error());
  const BuiltinScope scope(*this, builder);
  if (entry->number) return emit_elementwise(scope, *entry, *bound);
  return entry->call(scope, *bound);
}

std::vector<IrFloat> BuiltinScope::numbers(const Components& values) const {
  std::vector<IrFloat> result;
  for (const ir::Value value : values) result.push_back(number(value));
  return result;
}

Components BuiltinScope::values(std::span<const IrFloat> numbers) const {
  Components result;
  for (const IrFloat& number : numbers) result.push_back(place(*builder_, number));
  return result;
}

std::vector<IrFloat> BuiltinScope::call(std::string_view key, std::span<const IrFloat> floats,
                                        std::span<const IrInt> ints, const Body& body) const {
  ir::Module& module = builder_->module();
  auto found = emitter_->functions_.find(key);
  if (found == emitter_->functions_.end()) {
    // Write the function: parameters, body, results.
    if (module.functions.size() == module.functions.capacity()) {
      throw std::logic_error("no room was reserved for builtins in ir::Module::functions");
    }
    const auto index = static_cast<std::int32_t>(module.functions.size());
    ir::Function& function = module.functions.emplace_back();
    function.name = key;
    ir::Builder inner(module, function);
    std::vector<IrFloat> float_params;
    std::vector<IrInt> int_params;
    for (std::size_t i = 0; i < floats.size(); ++i) {
      float_params.emplace_back(inner, inner.add_param(function.body, ir::Type::f32));
    }
    for (std::size_t i = 0; i < ints.size(); ++i) {
      int_params.emplace_back(inner, inner.add_param(function.body, ir::Type::i32));
    }
    for (const IrFloat& result : body(float_params, int_params))
      function.body.yields.push_back(place(inner, result));
    found = emitter_->functions_.emplace(key, index).first;
  }

  // Call it.
  std::vector<ir::Value> operands;
  for (const IrFloat& argument : floats) operands.push_back(place(*builder_, argument));
  for (const IrInt& argument : ints) operands.push_back(place(*builder_, argument));
  const std::size_t results =
      module.functions[static_cast<std::size_t>(found->second)].body.yields.size();
  const std::vector<ir::Type> types(results, ir::Type::f32);
  std::vector<IrFloat> result;
  for (const ir::Value value : builder_->emit_multi(ir::Op::call, operands, types, found->second)) {
    result.push_back(number(value));
  }
  return result;
}

}  // namespace pse
