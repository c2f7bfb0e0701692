// Operators on numbers, vectors and matrices, and the conversions between them.
#include <cmath>
#include <limits>

#include "lower/lowering.h"

namespace pse::lower {

using lang::BinaryOp;

namespace {

const char* symbol(BinaryOp op) {
  switch (op) {
    case BinaryOp::add: return "+";
    case BinaryOp::subtract: return "-";
    case BinaryOp::multiply: return "*";
    case BinaryOp::divide: return "/";
    case BinaryOp::modulo: return "%";
    case BinaryOp::power: return "^";
    case BinaryOp::less: return "<";
    case BinaryOp::less_equal: return "<=";
    case BinaryOp::greater: return ">";
    case BinaryOp::greater_equal: return ">=";
    case BinaryOp::equal: return "==";
    case BinaryOp::not_equal: return "!=";
    case BinaryOp::logical_and: return "and";
    case BinaryOp::logical_or: return "or";
  }
  return "?";
}

bool holds(BinaryOp comparison, float x, float y) {
  switch (comparison) {
    case BinaryOp::less: return x < y;
    case BinaryOp::less_equal: return x <= y;
    case BinaryOp::greater: return x > y;
    case BinaryOp::greater_equal: return x >= y;
    case BinaryOp::equal: return x == y;
    default: return x != y;
  }
}

}  // namespace

// ---- Making values ------------------------------------------------------------------------------

ir::Value Lowering::constant(float value) {
  const ir::Value result = builder_->const_f32(value);
  constants_[result] = value;
  return result;
}
ir::Value Lowering::integer(std::int32_t value) { return builder_->const_i32(value); }
Typed Lowering::number(float value) { return number(constant(value)); }
Typed Lowering::number(ir::Value value) {
  return {.kind = Kind::number, .parts = {value}, .text = {}, .function = {}};
}
Typed Lowering::truth(ir::Value value) {
  return {.kind = Kind::boolean, .parts = {value}, .text = {}, .function = {}};
}
Typed Lowering::vector(std::vector<ir::Value> parts) {
  Typed result{.kind = Kind::vector, .parts = {}, .text = {}, .function = {}};
  result.rows = static_cast<int>(parts.size());
  result.parts = std::move(parts);
  return result;
}

std::optional<float> Lowering::known(ir::Value value) const {
  const auto found = constants_.find(value);
  if (found == constants_.end()) return {};
  return found->second;
}

Typed Lowering::zero_of(const Typed& shape) {
  Typed zero = shape;
  for (ir::Value& part : zero.parts)
    part = shape.kind == Kind::boolean ? builder_->const_bool(false)
           : builder_->type(part) == ir::Type::i32 ? integer(0)
                                                   : constant(0);
  return zero;
}

// ---- Conversions --------------------------------------------------------------------------------

Typed Lowering::to_number(const Typed& value) {
  if (value.kind != Kind::boolean) return value;
  return number(emit(ir::Op::select, {value.parts.front(), constant(1), constant(0)}));
}

Typed Lowering::to_truth(const Typed& value, const Span& span) {
  if (value.is_error() || value.kind == Kind::boolean) return value;
  if (value.kind == Kind::number)
    return truth(emit(ir::Op::fne, {value.parts.front(), constant(0)}));
  error("not-a-condition", span,
        "a condition is a truth value or a number, this is " + describe(value),
        value.kind == Kind::vector ? "compare one component, or its length" : "");
  return {};
}

ir::Value Lowering::to_index(const Typed& value) {
  return emit(ir::Op::isub, {emit(ir::Op::f2i, {value.parts.front()}), integer(1)});
}

Typed Lowering::promote(const Typed& value, const Typed& shape) {
  if (same_shape(value, shape)) return value;
  Typed result = to_number(value);
  if (result.kind == Kind::number && (shape.kind == Kind::vector || shape.kind == Kind::matrix)) {
    const ir::Value part = result.parts.front();
    result = shape;
    result.parts.assign(shape.parts.size(), part);
  }
  return result;
}

std::optional<Typed> Lowering::common_shape(const Typed& a, const Typed& b) const {
  if (same_shape(a, b)) return a;
  if (!a.is_numeric() || !b.is_numeric()) return {};
  const auto is_scalar = [](const Typed& v) {
    return v.kind == Kind::number || v.kind == Kind::boolean;
  };
  if (is_scalar(a) && is_scalar(b)) return a.kind == Kind::number ? a : b;
  if (is_scalar(a)) return b;
  if (is_scalar(b)) return a;
  return {};
}

// ---- Operators ----------------------------------------------------------------------------------

ir::Value Lowering::power(ir::Value a, ir::Value b) {
  // Small whole powers are products; roots and the reciprocal are at most 0.75 ulp off.
  if (const auto exponent = known(b)) {
    if (*exponent == 1) return a;
    if (*exponent == 2) return emit(ir::Op::fmul, {a, a});
    if (*exponent == -1) return emit(ir::Op::fdiv, {constant(1), a});
    if (*exponent == 0.5f || *exponent == 0.25f) {
      // As for pow, -0 counts as 0, and -infinity as infinity.
      constexpr float infinity = std::numeric_limits<float>::infinity();
      const ir::Value lowest = emit(ir::Op::feq, {a, constant(-infinity)});
      const ir::Value base =
          emit(ir::Op::select, {lowest, constant(infinity), emit(ir::Op::fadd, {a, constant(0)})});
      const ir::Value root = emit(ir::Op::fsqrt, {base});
      return *exponent == 0.5f ? root : emit(ir::Op::fsqrt, {root});
    }
    if (*exponent == 3) return emit(ir::Op::fmul, {emit(ir::Op::fmul, {a, a}), a});
    if (*exponent == 4) {
      const ir::Value square = emit(ir::Op::fmul, {a, a});
      return emit(ir::Op::fmul, {square, square});
    }
  }
  const auto result =
      builtins_->emit(*builder_, {.name = "pow", .arguments = {{a}, {b}}, .named = {}});
  return result ? result->front() : a;
}

ir::Value Lowering::scalar_op(BinaryOp op, ir::Value a, ir::Value b) {
  // Fold what is known, so that indices and array sizes can be seen.
  const auto x = known(a), y = known(b);
  if (x && y) {
    switch (op) {
      case BinaryOp::add: return constant(*x + *y);
      case BinaryOp::subtract: return constant(*x - *y);
      case BinaryOp::multiply: return constant(*x * *y);
      case BinaryOp::divide: return constant(*x / *y);
      default: break;
    }
  }
  switch (op) {
    case BinaryOp::add: return emit(ir::Op::fadd, {a, b});
    case BinaryOp::subtract: return emit(ir::Op::fsub, {a, b});
    case BinaryOp::multiply: return emit(ir::Op::fmul, {a, b});
    case BinaryOp::divide: return emit(ir::Op::fdiv, {a, b});
    case BinaryOp::modulo:
      return builtins_->emit(*builder_, {.name = "mod", .arguments = {{a}, {b}}, .named = {}})
          ->front();
    default: return power(a, b);
  }
}

Typed Lowering::negate(const Typed& a, const Span& span) {
  if (a.is_error()) return a;
  if (!a.is_numeric()) {
    error("operand-type", span, "`-` needs a number, a vector or a matrix, this is " + describe(a));
    return {};
  }
  Typed result = to_number(a);
  for (ir::Value& part : result.parts) {
    const auto fixed = known(part);
    part = fixed ? constant(-*fixed) : emit(ir::Op::fneg, {part});
  }
  return result;
}

Typed Lowering::matrix_product(const Typed& a, const Typed& b, const Span& span) {
  // Rows of a times columns of b; a vector on the left is a row, on the right a column.
  const int rows = a.kind == Kind::matrix ? a.rows : 1;
  const int inner = a.kind == Kind::matrix ? a.columns : a.rows;
  const int inner_b = b.rows;
  const int columns = b.kind == Kind::matrix ? b.columns : 1;
  if (inner != inner_b) {
    error("shapes", span, "cannot multiply " + describe(a) + " with " + describe(b),
          "the columns of the left must equal the rows of the right");
    return {};
  }
  std::vector<ir::Value> parts;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      ir::Value sum = ir::no_value;
      for (int k = 0; k < inner; ++k) {
        const ir::Value product =
            emit(ir::Op::fmul, {a.parts[static_cast<std::size_t>(r * inner + k)],
                                b.parts[static_cast<std::size_t>(k * columns + c)]});
        sum = sum == ir::no_value ? product : emit(ir::Op::fadd, {sum, product});
      }
      parts.push_back(sum);
    }
  if (a.kind == Kind::matrix && b.kind == Kind::matrix) {
    Typed result = a;
    result.columns = columns;
    result.parts = std::move(parts);
    return result;
  }
  return vector(std::move(parts));
}

Typed Lowering::arithmetic(BinaryOp op, const Typed& left, const Typed& right, const Span& span) {
  if (left.is_error() || right.is_error()) return {};
  const auto refuse = [&](const std::string& hint) {
    error("operand-types", span,
          std::string("`") + symbol(op) + "` does not work on " + describe(left) + " and " +
              describe(right),
          hint);
    return Typed{};
  };
  if (!left.is_numeric() || !right.is_numeric())
    return refuse(left.kind == Kind::function || right.kind == Kind::function
                      ? "call the function: `f(...)`"
                      : "");
  const Typed a = to_number(left), b = to_number(right);
  const bool a_matrix = a.kind == Kind::matrix, b_matrix = b.kind == Kind::matrix;
  if (op == BinaryOp::multiply && (a_matrix || b_matrix) && a.kind != Kind::number &&
      b.kind != Kind::number)
    return matrix_product(a, b, span);
  if (a.kind != Kind::number && b.kind != Kind::number && !same_shape(a, b))
    return refuse("the two must have the same number of components");

  // Component by component; a number goes with every component.
  Typed result = a.kind == Kind::number ? b : a;
  for (std::size_t i = 0; i < result.parts.size(); ++i)
    result.parts[i] = scalar_op(op, a.parts[a.kind == Kind::number ? 0 : i],
                                b.parts[b.kind == Kind::number ? 0 : i]);
  return result;
}

Typed Lowering::compare(BinaryOp op, const Typed& left, const Typed& right, const Span& span) {
  if (left.is_error() || right.is_error()) return {};
  const bool equality = op == BinaryOp::equal || op == BinaryOp::not_equal;
  if (left.kind == Kind::text && right.kind == Kind::text && equality)
    return truth(builder_->const_bool((left.text == right.text) == (op == BinaryOp::equal)));
  const Typed a = to_number(left), b = to_number(right);
  const bool numbers = a.kind == Kind::number && b.kind == Kind::number;
  if (!numbers && !(equality && a.is_numeric() && common_shape(a, b))) {
    error("operand-types", span,
          std::string("`") + symbol(op) + "` does not compare " + describe(left) + " and " +
              describe(right),
          left.is_numeric() && right.is_numeric() ? "compare one component, or their lengths" : "");
    return {};
  }
  const auto one = [&](ir::Value x, ir::Value y) {
    switch (op) {
      case BinaryOp::less: return emit(ir::Op::flt, {x, y});
      case BinaryOp::less_equal: return emit(ir::Op::fle, {x, y});
      case BinaryOp::greater: return emit(ir::Op::flt, {y, x});
      case BinaryOp::greater_equal: return emit(ir::Op::fle, {y, x});
      case BinaryOp::equal: return emit(ir::Op::feq, {x, y});
      default: return emit(ir::Op::fne, {x, y});
    }
  };
  // Two vectors are equal when all components are.
  const std::size_t count = std::max(a.parts.size(), b.parts.size());
  ir::Value result = ir::no_value;
  for (std::size_t i = 0; i < count; ++i) {
    const ir::Value here =
        one(a.parts[a.parts.size() == 1 ? 0 : i], b.parts[b.parts.size() == 1 ? 0 : i]);
    if (result == ir::no_value)
      result = here;
    else
      result = emit(op == BinaryOp::equal ? ir::Op::band : ir::Op::bor, {result, here});
  }
  // Lengths are often compared, and known.
  if (const auto x = known(a.parts.front()), y = known(b.parts.front()); numbers && x && y)
    constants_[result] = holds(op, *x, *y) ? 1.0f : 0.0f;
  return truth(result);
}

}  // namespace pse::lower
