// Between the groups of builtins (builtins_*.cpp) and their emitter (builtins.cpp): how an entry
// says what it emits.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lower/builtins.h"
#include "lower/ir_value.h"

namespace pse {

// Where an entry emits: the place of the call, and the module's functions.
class BuiltinScope {
 public:
  BuiltinScope(BuiltinEmitter& emitter, ir::Builder& builder)
      : emitter_(&emitter), builder_(&builder) {}

  ir::Builder& builder() const { return *builder_; }
  IrFloat number(ir::Value value) const { return {*builder_, value}; }
  std::vector<IrFloat> numbers(const Components& values) const;
  Components values(std::span<const IrFloat> numbers) const;

  using Body = std::function<std::vector<IrFloat>(std::span<const IrFloat> floats,
                                                  std::span<const IrInt> ints)>;
  // Calls the function `key` of these arguments; the first such call in a module writes it with
  // `body`.
  std::vector<IrFloat> call(std::string_view key, std::span<const IrFloat> floats,
                            std::span<const IrInt> ints, const Body& body) const;

 private:
  BuiltinEmitter* emitter_;
  ir::Builder* builder_;
};

// A call's arguments, one for each parameter of the entry; empty where a parameter with a default
// was left out. The arguments of a parameter `name...` are strung together into one.
struct BoundCall {
  std::string_view name;
  std::vector<Components> arguments;
};

using EmitNumber = IrFloat (*)(std::span<const IrFloat>);
using EmitCall = std::expected<Components, std::string> (*)(const BuiltinScope&, const BoundCall&);

struct BuiltinEntry {
  Builtin builtin;
  // Exactly one of these. `number` is for elementwise entries; large ones become functions of the
  // module.
  EmitNumber number = nullptr;
  bool large = false;
  EmitCall call = nullptr;
};

// The groups, in the order of the manual.
std::span<const BuiltinEntry> math_builtins();
std::span<const BuiltinEntry> vector_builtins();
std::span<const BuiltinEntry> noise_builtins();
std::span<const BuiltinEntry> random_builtins();

}  // namespace pse
