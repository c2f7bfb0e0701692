// Rules of the calculus, one by one. Where a slope is infinite it comes out as infinity or NaN, and
// edges that depend on it are found by more samples.
#include "passes/slope_rules.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>

namespace pse::passes {

using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Value;

namespace {

// Sums that leave out what is 0.
Value plus(const Emit& e, Value a, Value b) {
  if (a == no_value || b == no_value) return a == no_value ? b : a;
  return e.add(a, b);
}
Value times(const Emit& e, Value factor, Value slope) {
  return slope == no_value ? no_value : e.mul(factor, slope);
}
Value or_zero(const Emit& e, Value slope) { return slope == no_value ? e.number(0) : slope; }
Value minus(const Emit& e, Value a) { return e(Op::fneg, {a}); }

}  // namespace

Value slope_of(const Emit& e, const Instruction& in, const std::vector<Value>& s) {
  const auto& x = in.operands;
  switch (in.op) {
    case Op::fadd:
      return plus(e, s[0], s[1]);
    case Op::fsub:
      if (s[1] == no_value) return s[0];
      return s[0] == no_value ? minus(e, s[1]) : e.sub(s[0], s[1]);
    case Op::fmul:
      return plus(e, times(e, x[1], s[0]), times(e, x[0], s[1]));
    case Op::fdiv: {
      // The same factor along x and y, so computed once.
      const Value factor = e.div(e.number(1), x[1]);
      if (s[1] == no_value) return e.mul(s[0], factor);
      return e.mul(e.sub(or_zero(e, s[0]), e.mul(in.result(), s[1])), factor);
    }
    case Op::fma:
      return plus(e, plus(e, times(e, x[1], s[0]), times(e, x[0], s[1])), s[2]);
    case Op::fneg:
      return minus(e, s[0]);
    case Op::fabs:
      return e.choose(e.less(x[0], e.number(0)), minus(e, s[0]), s[0]);
    case Op::fsqrt:
      return e.mul(s[0], e.div(e.number(0.5f), in.result()));
    case Op::fmin:
      return e.choose(e.less(x[0], x[1]), or_zero(e, s[0]), or_zero(e, s[1]));
    case Op::fmax:
      return e.choose(e.less(x[1], x[0]), or_zero(e, s[0]), or_zero(e, s[1]));
    case Op::select:
      return e.choose(x[0], or_zero(e, s[1]), or_zero(e, s[2]));
    default:
      return e.number(0);
  }
}

bool has_partials(const std::string& name) {
  static constexpr std::array<std::string_view, 19> known = {
      "sin",  "cos",   "tan", "asin", "acos",  "atan",  "sinh", "cosh",  "tanh", "exp",
      "exp2", "expm1", "log", "log2", "log10", "log1p", "cbrt", "atan2", "hypot"};
  return name == "pow" || std::ranges::find(known, name) != known.end();
}

std::optional<std::vector<Value>> partials_of(const Emit& e, const std::string& name,
                                              const Instruction& call,
                                              const std::vector<bool>& wanted) {
  const Value a = call.operands.empty() ? no_value : call.operands[0];
  const Value y = call.results.front();
  const auto is = [&](const char* other) { return name == other; };
  const auto number = [&](double value) { return e.number(static_cast<float>(value)); };
  const Value one = number(1);
  const auto one_value = [](Value value) { return std::vector{value}; };
  // The same function elsewhere.
  const auto at = [&](std::vector<Value> arguments) {
    const Value result = e.function().add_value(ir::Type::f32);
    e.out().push_back({.op = Op::call,
                       .operands = std::move(arguments),
                       .results = {result},
                       .imm = call.imm,
                       .span = call.span});
    return result;
  };
  const auto root = [&](Value v) { return e(Op::fsqrt, {v}); };
  const double pi = std::numbers::pi, ln2 = std::numbers::ln2, ln10 = std::numbers::ln10;

  // A quarter of a turn on, a sine is a cosine and a cosine a negative sine.
  if (is("sin") || is("cos")) return one_value(at({e.add(a, number(pi / 2))}));
  if (is("tan")) return one_value(e(Op::fma, {y, y, one}));
  if (is("asin")) return one_value(e.div(one, root(e.sub(one, e.mul(a, a)))));
  if (is("acos")) return one_value(e.div(number(-1), root(e.sub(one, e.mul(a, a)))));
  if (is("atan")) return one_value(e.div(one, e(Op::fma, {a, a, one})));
  if (is("sinh")) return one_value(root(e(Op::fma, {y, y, one})));
  if (is("cosh")) {
    // sinh is sqrt(cosh^2 - 1), and a + a^3 / 6 where that has lost its digits.
    const Value size = root(e(Op::fma, {y, y, number(-1)}));
    const Value sinh = e.choose(e.less(a, number(0)), minus(e, size), size);
    const Value small = e.mul(a, e(Op::fma, {e.mul(a, a), number(1.0 / 6), one}));
    return one_value(e.choose(e.less(e(Op::fabs, {a}), number(0.3)), small, sinh));
  }
  if (is("tanh")) return one_value(e.sub(one, e.mul(y, y)));
  if (is("exp")) return one_value(y);
  if (is("exp2")) return one_value(e.mul(y, number(ln2)));
  if (is("expm1")) return one_value(e.add(y, one));
  if (is("log")) return one_value(e.div(one, a));
  if (is("log2")) return one_value(e.div(number(1 / ln2), a));
  if (is("log10")) return one_value(e.div(number(1 / ln10), a));
  if (is("log1p")) return one_value(e.div(one, e.add(one, a)));
  if (is("cbrt")) return one_value(e.div(one, e.mul(number(3), e.mul(y, y))));
  if (is("pow")) {
    const Value b = call.operands[1];
    std::vector<Value> partials(2, no_value);
    if (wanted[0]) partials[0] = e.mul(b, at({a, e.sub(b, one)}));
    if (wanted[1]) {
      // y log(a), the logarithm by two powers close by.
      const double h = 1.0 / 64;
      partials[1] =
          e.mul(e.sub(at({a, e.add(b, number(h))}), at({a, e.sub(b, number(h))})), number(0.5 / h));
    }
    return partials;
  }
  if (is("atan2")) {
    const Value x = call.operands[1];
    const Value square = e(Op::fma, {x, x, e.mul(a, a)});
    return std::vector{e.div(x, square), e.div(minus(e, a), square)};
  }
  if (is("hypot")) return std::vector{e.div(a, y), e.div(call.operands[1], y)};
  return std::nullopt;
}

}  // namespace pse::passes
