// Evaluation of constant expressions on the tree.
#include "lower/constant.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace pse::lower {
namespace {

using namespace lang;

constexpr std::pair<const char*, float> constants[] = {
    {"PI", std::numbers::pi_v<float>},
    {"TAU", 2 * std::numbers::pi_v<float>},
    {"E", std::numbers::e_v<float>},
    {"INF", std::numeric_limits<float>::infinity()},
    {"NAN", std::numeric_limits<float>::quiet_NaN()},
};

// Colours by name, linear Rec. 709.
constexpr std::pair<const char*, std::array<float, 3>> colours[] = {
    {"white", {1, 1, 1}},   {"black", {0, 0, 0}},
    {"red", {1, 0, 0}},     {"green", {0, 1, 0}},
    {"blue", {0, 0, 1}},    {"cyan", {0, 1, 1}},
    {"magenta", {1, 0, 1}}, {"yellow", {1, 1, 0}},
    {"gray", {0.18f, 0.18f, 0.18f}}, {"grey", {0.18f, 0.18f, 0.18f}},
};

std::optional<float> apply(BinaryOp op, float a, float b) {
  switch (op) {
    case BinaryOp::add: return a + b;
    case BinaryOp::subtract: return a - b;
    case BinaryOp::multiply: return a * b;
    case BinaryOp::divide: return a / b;
    case BinaryOp::power:
      return static_cast<float>(std::pow(static_cast<double>(a), static_cast<double>(b)));
    default: return {};
  }
}

std::optional<ConstantValue> vector_of(const std::vector<ExprPtr>& elements) {
  ConstantValue result;
  for (const ExprPtr& element : elements) {
    const auto value = element ? constant_value(*element) : std::nullopt;
    if (!value || value->is_text || value->numbers.size() != 1) return {};
    result.numbers.push_back(value->numbers.front());
  }
  if (result.numbers.size() < 2) return {};
  return result;
}

}  // namespace

std::optional<float> named_constant(const std::string& name) {
  for (const auto& [known, value] : constants)
    if (name == known) return value;
  return {};
}

std::vector<std::string> named_constants() {
  std::vector<std::string> names;
  for (const auto& [known, value] : constants) names.emplace_back(known);
  return names;
}

std::optional<std::array<float, 3>> named_colour(const std::string& name) {
  for (const auto& [known, rgb] : colours)
    if (name == known) return rgb;
  return {};
}

std::vector<std::string> named_colours() {
  std::vector<std::string> names;
  for (const auto& [known, rgb] : colours) names.emplace_back(known);
  return names;
}

std::optional<ConstantValue> constant_value(const Expr& expr) {
  if (const auto* number = std::get_if<NumberExpr>(&expr.node))
    return ConstantValue{.numbers = {static_cast<float>(number->value)}, .text = {}};
  if (const auto* truth = std::get_if<BoolExpr>(&expr.node))
    return ConstantValue{.numbers = {truth->value ? 1.0f : 0.0f}, .text = {}, .is_boolean = true};
  if (const auto* text = std::get_if<StringExpr>(&expr.node))
    return ConstantValue{.numbers = {}, .text = text->value, .is_text = true};
  if (const auto* name = std::get_if<NameExpr>(&expr.node)) {
    if (const auto value = named_constant(name->name))
      return ConstantValue{.numbers = {*value}, .text = {}};
    if (const auto rgb = named_colour(name->name))
      return ConstantValue{.numbers = {rgb->begin(), rgb->end()}, .text = {}};
    return {};
  }
  if (const auto* vector = std::get_if<VectorExpr>(&expr.node)) return vector_of(vector->elements);
  if (const auto* tuple = std::get_if<TupleExpr>(&expr.node)) return vector_of(tuple->elements);
  if (const auto* unary = std::get_if<UnaryExpr>(&expr.node)) {
    auto value = constant_value(*unary->operand);
    if (!value || value->is_text || unary->op != UnaryOp::negate) return {};
    for (float& number : value->numbers) number = -number;
    value->is_boolean = false;
    return value;
  }
  if (const auto* binary = std::get_if<BinaryExpr>(&expr.node)) {
    const auto a = constant_value(*binary->left), b = constant_value(*binary->right);
    if (!a || !b || a->is_text || b->is_text) return {};
    const std::size_t count = std::max(a->numbers.size(), b->numbers.size());
    ConstantValue result;
    for (std::size_t i = 0; i < count; ++i) {
      if ((a->numbers.size() != 1 && i >= a->numbers.size()) ||
          (b->numbers.size() != 1 && i >= b->numbers.size()))
        return {};
      const auto value = apply(binary->op, a->numbers[a->numbers.size() == 1 ? 0 : i],
                               b->numbers[b->numbers.size() == 1 ? 0 : i]);
      if (!value) return {};
      result.numbers.push_back(*value);
    }
    return result;
  }
  return {};
}

}  // namespace pse::lower
