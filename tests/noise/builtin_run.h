// Calls a builtin as a program would: emitted into a module, then run by the interpreter of the IR.
#pragma once

#include <bit>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ir/interpreter.h"
#include "lower/builtins.h"

namespace pse::test {

using Vectors = std::vector<std::vector<float>>;

// A module whose program is one call of a builtin on its inputs, which are the arguments in order.
struct BuiltinProgram {
  ir::Module module;
  std::string error;
  std::vector<float> inputs;

  BuiltinProgram(const std::string& name, const Vectors& arguments,
                 const std::vector<std::pair<std::string, std::vector<float>>>& named = {}) {
    module.functions.reserve(1 + BuiltinEmitter::room_for_builtins);
    ir::Builder builder(module, module.functions.emplace_back());
    const auto place = [&](const std::vector<float>& numbers) {
      Components components;
      for (const float number : numbers) {
        components.push_back(
            builder.emit(ir::Op::input, {}, static_cast<std::int32_t>(module.inputs.size())));
        module.inputs.push_back({"input." + std::to_string(inputs.size()), ir::Rate::sample});
        inputs.push_back(number);
      }
      return components;
    };
    BuiltinCall call{name, {}, {}};
    for (const auto& argument : arguments) call.arguments.push_back(place(argument));
    for (const auto& [key, argument] : named) call.named.emplace_back(key, place(argument));
    const auto result = BuiltinEmitter(module).emit(builder, call);
    if (!result) {
      error = result.error();
      return;
    }
    for (const ir::Value value : *result) {
      module.main().body.yields.push_back(value);
      module.outputs.push_back({"output"});
    }
  }

  std::vector<float> run(const std::vector<float>& values) const {
    if (!error.empty()) throw std::runtime_error(error);
    std::vector<float> results;
    for (const ir::Bits bits : ir::interpret(module, module.entry, values).results) {
      results.push_back(std::bit_cast<float>(bits));
    }
    return results;
  }
  std::vector<float> run() const { return run(inputs); }
};

inline std::vector<float> run_builtin(
    const std::string& name, const Vectors& arguments,
    const std::vector<std::pair<std::string, std::vector<float>>>& named = {}) {
  return BuiltinProgram(name, arguments, named).run();
}

// Every NaN is the same value.
inline bool same(float a, float b) {
  return (a != a && b != b) || std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

}  // namespace pse::test
