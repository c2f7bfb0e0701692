// Constant values of the tree: what makes a knob a knob.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lang/ast.h"

namespace pse::lower {

struct ConstantValue {
  std::vector<float> numbers;  // one for a number or truth value, n for a vector
  std::string text;
  bool is_text = false;
  bool is_boolean = false;
};

// The value of an expression made of literals, named constants (PI, white, ...), vectors and
// arithmetic alone; else nothing.
std::optional<ConstantValue> constant_value(const lang::Expr& expr);

// PI, TAU, E, INF, NAN.
std::optional<float> named_constant(const std::string& name);
std::vector<std::string> named_constants();

// white, black, red and so on: linear Rec. 709.
std::optional<std::array<float, 3>> named_colour(const std::string& name);
std::vector<std::string> named_colours();

}  // namespace pse::lower
