// Expressions: each becomes a Typed, its components IR values.
#include <algorithm>
#include <bit>
#include <cstring>

#include "lower/constant.h"
#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

namespace {

// Nested expressions, statements and calls; bounds the machine's stack.
constexpr int deepest = 1500;

struct DepthGuard {
  explicit DepthGuard(int& depth) : depth_(depth) { ++depth_; }
  ~DepthGuard() { --depth_; }
  DepthGuard(const DepthGuard&) = delete;
  DepthGuard& operator=(const DepthGuard&) = delete;
  int& depth_;
};

}  // namespace

Typed Lowering::lower(const Expr& expr) {
  const DepthGuard guard(depth_);
  if (depth_ > deepest) {
    error("too-deep", expr.span, "this is nested too deeply",
          "give parts of it names of their own");
    throw TooLarge{};
  }
  builder_->set_span(expr.span);
  check_size();
  Typed result = lower_node(expr);
  builder_->set_span(expr.span);
  return result;
}

Typed Lowering::lower_node(const Expr& expr) {
  const Span& span = expr.span;
  if (const auto* e = std::get_if<NumberExpr>(&expr.node))
    return number(static_cast<float>(e->value));
  if (const auto* e = std::get_if<NameExpr>(&expr.node)) return lower_name(e->name, span);
  if (const auto* e = std::get_if<BinaryExpr>(&expr.node)) return lower_binary(expr, *e);
  if (const auto* e = std::get_if<CallExpr>(&expr.node)) return lower_call(*e, span);
  if (const auto* e = std::get_if<VectorExpr>(&expr.node)) return lower_vector(e->elements, span);
  if (const auto* e = std::get_if<TupleExpr>(&expr.node)) return lower_vector(e->elements, span);
  if (const auto* e = std::get_if<IndexExpr>(&expr.node)) return lower_index(*e, span);
  if (const auto* e = std::get_if<MemberExpr>(&expr.node)) return lower_member(*e, span);
  if (const auto* e = std::get_if<ConditionalExpr>(&expr.node)) return lower_conditional(*e, span);
  if (const auto* e = std::get_if<BoolExpr>(&expr.node))
    return truth(builder_->const_bool(e->value));
  if (const auto* e = std::get_if<StringExpr>(&expr.node))
    return {.kind = Kind::text, .parts = {}, .text = e->value, .function = {}};
  if (const auto* e = std::get_if<UnaryExpr>(&expr.node)) {
    const Typed operand = lower(*e->operand);
    if (e->op == UnaryOp::negate) return negate(operand, span);
    const Typed condition = to_truth(operand, e->operand->span);
    return condition.is_error() ? condition : truth(emit(ir::Op::bnot, {condition.parts.front()}));
  }
  const auto& range = std::get<RangeExpr>(expr.node);
  const auto first = constant_value(*range.first), last = constant_value(*range.last);
  const auto step =
      range.step ? constant_value(*range.step) : ConstantValue{.numbers = {1.0f}, .text = {}};
  if (first && last && step && first->numbers.size() == 1 && last->numbers.size() == 1 &&
      step->numbers.size() == 1 && step->numbers[0] != 0) {
    // A short constant range is a vector.
    const float count = (last->numbers[0] - first->numbers[0]) / step->numbers[0];
    if (count >= 1 && count < 256) {
      std::vector<ir::Value> parts;
      for (int i = 0; i <= static_cast<int>(count); ++i)
        parts.push_back(constant(first->numbers[0] + static_cast<float>(i) * step->numbers[0]));
      return vector(std::move(parts));
    }
  }
  error("range-here", span, "a range stands only in `for ... in [a .. b]`",
        "between constants, with 2 to 256 steps, it is also a vector");
  return {};
}

Typed Lowering::lower_vector(const std::vector<ExprPtr>& elements, const Span& span) {
  std::vector<Typed> values;
  bool failed = false;
  for (const ExprPtr& element : elements) {
    values.push_back(to_number(lower(*element)));
    const Typed& value = values.back();
    failed = failed || value.is_error();
    if (!value.is_error() && value.kind != Kind::number && value.kind != Kind::vector) {
      error("element-type", element->span,
            "a vector is made of numbers, this is " + describe(value));
      failed = true;
    }
  }
  if (failed) return {};
  if (values.empty()) {
    error("empty-vector", span, "a vector needs at least one number",
          "for an empty array write `array(1000)`");
    return {};
  }

  // Equal vectors make a matrix; otherwise numbers and vectors are strung together, as in [p.xy 1].
  bool is_matrix = values.size() > 1 || values.front().kind == Kind::vector;
  for (const Typed& value : values)
    is_matrix = is_matrix && value.kind == Kind::vector && value.rows == values.front().rows;
  std::vector<ir::Value> parts;
  for (const Typed& value : values)
    parts.insert(parts.end(), value.parts.begin(), value.parts.end());
  if (parts.size() > 4096) {
    error("vector-size", span, "a vector has at most 4096 components");
    return {};
  }
  if (is_matrix) {
    Typed result{.kind = Kind::matrix, .parts = std::move(parts), .text = {}, .function = {}};
    result.rows = static_cast<int>(values.size());
    result.columns = values.front().rows;
    return result;
  }
  if (parts.size() == 1) return number(parts.front());
  return vector(std::move(parts));
}

Typed Lowering::lower_binary(const Expr& expr, const BinaryExpr& binary) {
  if (binary.op == BinaryOp::logical_and || binary.op == BinaryOp::logical_or)
    return lower_logical(expr, binary);
  const Typed a = lower(*binary.left);
  const Typed b = lower(*binary.right);
  builder_->set_span(expr.span);
  switch (binary.op) {
    case BinaryOp::less:
    case BinaryOp::less_equal:
    case BinaryOp::greater:
    case BinaryOp::greater_equal:
    case BinaryOp::equal:
    case BinaryOp::not_equal: return compare(binary.op, a, b, expr.span);
    default: return arithmetic(binary.op, a, b, expr.span);
  }
}

Typed Lowering::lower_logical(const Expr& expr, const BinaryExpr& binary) {
  const Typed a = to_truth(lower(*binary.left), binary.left->span);
  if (a.is_error()) {
    to_truth(lower(*binary.right), binary.right->span);
    return {};
  }
  // The right side is evaluated only where the left does not decide.
  const auto right = [&] { return to_truth(lower(*binary.right), binary.right->span); };
  const auto decided = [&](bool value) {
    return [this, value] { return truth(builder_->const_bool(value)); };
  };
  if (binary.op == BinaryOp::logical_and)
    return branch_value(a.parts.front(), right, decided(false), expr.span);
  return branch_value(a.parts.front(), decided(true), right, expr.span);
}

Typed Lowering::lower_conditional(const ConditionalExpr& conditional, const Span& span) {
  const Typed condition = to_truth(lower(*conditional.condition), conditional.condition->span);
  const ir::Value value =
      condition.is_error() ? builder_->const_bool(false) : condition.parts.front();
  return branch_value(
      value, [&] { return lower(*conditional.if_true); },
      [&] { return lower(*conditional.if_false); }, span);
}

Typed Lowering::element_of(const Typed& base, const Typed& index, const Span& span,
                           const std::string& what) {
  // A vector's component or a matrix's row.
  const int stride = base.kind == Kind::matrix ? base.columns : 1;
  const auto row = [&](int at) {
    std::vector<ir::Value> parts(base.parts.begin() + at * stride,
                                 base.parts.begin() + (at + 1) * stride);
    return stride == 1 && base.kind != Kind::matrix ? number(parts.front())
                                                    : vector(std::move(parts));
  };
  const std::string name = what.empty() ? "" : " of `" + what + "`";
  if (const auto fixed = known(index.parts.front())) {
    if (!(*fixed >= 1 && *fixed < static_cast<float>(base.rows + 1))) {
      error("index-range", span,
            "this index" + name + " is outside 1.." + std::to_string(base.rows),
            "indices count from 1");
      return {};
    }
    return row(static_cast<int>(*fixed) - 1);
  }
  const ir::Value at = to_index(index);
  add_check(emit(ir::Op::band, {emit(ir::Op::ile, {integer(0), at}),
                                emit(ir::Op::ilt, {at, integer(base.rows)})}),
            "index" + name + " is outside 1.." + std::to_string(base.rows), span);
  Typed result = row(0);

  // Constants are looked up in a table; other values are chosen one by one.
  bool all_known = true;
  for (const ir::Value part : base.parts) all_known = all_known && known(part).has_value();
  if (all_known) {
    for (int c = 0; c < stride; ++c) {
      std::vector<float> column;
      for (int k = 0; k < base.rows; ++k)
        column.push_back(*known(base.parts[static_cast<std::size_t>(k * stride + c)]));
      result.parts[static_cast<std::size_t>(c)] =
          emit(ir::Op::table_f32, {at}, constant_table(std::move(column)));
    }
    return result;
  }
  for (int k = 1; k < base.rows; ++k) {
    const ir::Value here = emit(ir::Op::ieq, {at, integer(k)});
    const Typed other = row(k);
    for (std::size_t c = 0; c < result.parts.size(); ++c)
      result.parts[c] = emit(ir::Op::select, {here, other.parts[c], result.parts[c]});
  }
  return result;
}

std::int32_t Lowering::constant_table(std::vector<float> entries) {
  // Tables have a power of two of entries; equal ones are shared.
  entries.resize(std::bit_ceil(entries.size()), entries.back());
  const auto same_bits = [&](const ir::FloatTable& table) {
    return table.entries.size() == entries.size() &&
           std::memcmp(table.entries.data(), entries.data(), entries.size() * sizeof(float)) == 0;
  };
  auto& tables = module_.float_tables;
  const auto found = std::find_if(tables.begin(), tables.end(), same_bits);
  if (found != tables.end()) return static_cast<std::int32_t>(found - tables.begin());
  tables.push_back({"constants" + std::to_string(tables.size()), std::move(entries)});
  return static_cast<std::int32_t>(tables.size()) - 1;
}

Typed Lowering::lower_index(const IndexExpr& index, const Span& span) {
  const Typed base = lower(*index.base);
  if (base.is_error()) return {};
  std::vector<Typed> positions;
  for (const ExprPtr& e : index.indices) {
    const Typed position = to_number(lower(*e));
    if (position.is_error()) return {};
    if (position.kind != Kind::number) {
      error("index-type", e->span, "an index must be a number, this is " + describe(position));
      return {};
    }
    positions.push_back(position);
  }
  const auto* name = std::get_if<NameExpr>(&index.base->node);
  const std::string what = name ? name->name : "";
  if (base.kind == Kind::array && positions.size() == 1)
    return load_element(base, to_index(positions[0]), span, true);
  if (base.kind == Kind::vector && positions.size() == 1)
    return element_of(base, positions[0], span, what);
  if (base.kind == Kind::matrix && positions.size() <= 2) {
    const Typed row = element_of(base, positions[0], span, what);
    return positions.size() == 1 || row.is_error() ? row
                                                   : element_of(row, positions[1], span, what);
  }
  error("index-base", span,
        base.kind == Kind::vector || base.kind == Kind::matrix || base.kind == Kind::array
            ? describe(base) + " takes fewer indices"
            : describe(base) + " has no elements");
  return {};
}

Typed Lowering::lower_member(const MemberExpr& member, const Span& span) {
  // A channel of a named image, when no variable hides it.
  if (const auto* base = std::get_if<NameExpr>(&member.base->node);
      base && !variables().contains(base->name)) {
    if (const StreamName* channel = stream_name(base->name + "." + member.name))
      return read_stream(*channel);
    bool is_image = false;
    std::vector<std::string> channels;
    for (const StreamName& known_name : options_.stream)
      if (known_name.name.starts_with(base->name + ".")) {
        is_image = true;
        channels.push_back(known_name.name.substr(base->name.size() + 1));
      }
    if (is_image && !stream_name(base->name)) {
      error("unknown-channel", member.name_span,
            "image `" + base->name + "` has no channel `" + member.name + "`",
            did_you_mean(member.name, channels));
      return {};
    }
    if (const auto module = call_->scope->named_imports.find(base->name);
        module != call_->scope->named_imports.end()) {
      bool found = false;
      const Typed value = lower_module_constant(module->second, member.name, span, found);
      if (found) return value;
      if (const auto function = find_function(member.name, module->second))
        return {.kind = Kind::function, .parts = {}, .text = {}, .function = *function};
    }
  }
  const Typed base = lower(*member.base);
  if (base.is_error()) return {};
  if (base.kind != Kind::vector && base.kind != Kind::number) {
    error("member-base", span, describe(base) + " has no component `" + member.name + "`");
    return {};
  }

  if (const auto part = hit_part(base, member.name)) return *part;

  // Each letter names a component; all letters come from one of the three sets.
  std::vector<ir::Value> parts;
  for (const std::string_view letters : {"xyzw", "rgba", "uv"}) {
    parts.clear();
    for (const char letter : member.name) {
      const std::size_t at = letters.find(letter);
      if (at == std::string_view::npos || at >= base.parts.size()) break;
      parts.push_back(base.parts[at]);
    }
    if (parts.size() == member.name.size())
      return parts.size() == 1 ? number(parts.front()) : vector(parts);
  }
  // The first letter that names nothing is the one to look at.
  std::string wrong = member.name;
  for (const std::string_view letters : {"xyzw", "rgba", "uv"}) {
    if (letters.find(member.name.front()) == std::string_view::npos) continue;
    const auto outside = std::ranges::find_if(
        member.name, [&](char letter) { return letters.find(letter) >= base.parts.size(); });
    if (outside != member.name.end()) wrong = *outside;
  }
  error("unknown-component", member.name_span, describe(base) + " has no component `" + wrong + "`",
        "components are named x y z w, r g b a or u v");
  return {};
}

}  // namespace pse::lower
