// Builtins that are random but not smooth: hash.
#include <array>

#include "lower/builtin_table.h"
#include "noise/random.h"

namespace pse {
namespace {

std::expected<Components, std::string> hash(const BuiltinScope& scope, const BoundCall& call) {
  const std::vector<IrFloat> arguments = scope.numbers(call.arguments[0]);
  const std::array result = {num::random_of<IrFloat>(arguments)};
  return scope.values(result);
}

const std::vector<BuiltinEntry> random_list = {
    {.builtin = {"hash", "noise", "v...", ResultShape::number,
                 "a random number in [0, 1) that depends on every bit of all components", ""},
     .call = hash},
    {.builtin = {"random", "noise", "", ResultShape::number, "", "hash"}},
};

}  // namespace

std::span<const BuiltinEntry> random_builtins() { return random_list; }

}  // namespace pse
