// Builtins on vectors whose result has another shape than their arguments.
#include <fmt/format.h>

#include "lower/builtin_table.h"

namespace pse {
namespace {

using Result = std::expected<Components, std::string>;

// The sum of products, from the last component to the first with one rounding each.
IrFloat inner_product(std::span<const IrFloat> a, std::span<const IrFloat> b) {
  IrFloat sum = a.back() * b.back();
  for (std::size_t i = a.size() - 1; i-- > 0;) sum = fma(a[i], b[i], sum);
  return sum;
}

Result dot(const BuiltinScope& scope, const BoundCall& call) {
  if (call.arguments[0].size() != call.arguments[1].size()) {
    return std::unexpected(
        fmt::format("`dot` takes two vectors of one length, and these have {} and {} components",
                    call.arguments[0].size(), call.arguments[1].size()));
  }
  return scope.values(std::array{
      inner_product(scope.numbers(call.arguments[0]), scope.numbers(call.arguments[1]))});
}

Result cross(const BuiltinScope& scope, const BoundCall& call) {
  if (call.arguments[0].size() != 3 || call.arguments[1].size() != 3) {
    return std::unexpected("`cross` takes two vectors of three components");
  }
  const auto a = scope.numbers(call.arguments[0]);
  const auto b = scope.numbers(call.arguments[1]);
  const auto component = [&](std::size_t i, std::size_t j) {
    return fma(a[i], b[j], -(a[j] * b[i]));
  };
  return scope.values(std::array{component(1, 2), component(2, 0), component(0, 1)});
}

// Folds all components of the arguments into one number, from the first on.
template <class Operation>
Result fold(const BuiltinScope& scope, const BoundCall& call, const Operation& operation) {
  const auto numbers = scope.numbers(call.arguments[0]);
  IrFloat result = numbers.front();
  for (std::size_t i = 1; i < numbers.size(); ++i) result = operation(result, numbers[i]);
  return scope.values(std::array{result});
}

Result sum(const BuiltinScope& scope, const BoundCall& call) {
  return fold(scope, call, [](const IrFloat& a, const IrFloat& b) { return a + b; });
}
Result product(const BuiltinScope& scope, const BoundCall& call) {
  return fold(scope, call, [](const IrFloat& a, const IrFloat& b) { return a * b; });
}

constexpr BuiltinEntry vector_list[] = {
    {.builtin = {"dot", "vector", "a, b", ResultShape::number, "the inner product of two vectors",
                 ""},
     .call = dot},
    {.builtin = {"cross", "vector", "a, b", ResultShape::vector3,
                 "the vector at right angles to a and b, as long as their parallelogram is large",
                 ""},
     .call = cross},
    {.builtin = {"sum", "vector", "v...", ResultShape::number, "the sum of all components", ""},
     .call = sum},
    {.builtin = {"product", "vector", "v...", ResultShape::number, "the product of all components",
                 ""},
     .call = product},
};

}  // namespace

std::span<const BuiltinEntry> vector_builtins() { return vector_list; }

}  // namespace pse
