// Expressions, by precedence climbing: docs/grammar.md, "Expressions".
#include <algorithm>

#include "lang/lexer.h"
#include "lang/parser_state.h"

namespace pse::lang {

namespace {

using enum TokenKind;

// Levels of the operators between two operands, from low to high. `not` stands between `and` and
// the comparisons.
constexpr int level_or = 1, level_and = 2, level_not = 3, level_compare = 4, level_sum = 5,
              level_product = 6;

struct Operator {
  int level = 0;  // 0: no operator between operands
  BinaryOp op = BinaryOp::add;
};

Operator operator_of(TokenKind kind) {
  switch (kind) {
    case kw_or:
      return {level_or, BinaryOp::logical_or};
    case kw_and:
      return {level_and, BinaryOp::logical_and};
    case less:
      return {level_compare, BinaryOp::less};
    case less_equal:
      return {level_compare, BinaryOp::less_equal};
    case greater:
      return {level_compare, BinaryOp::greater};
    case greater_equal:
      return {level_compare, BinaryOp::greater_equal};
    case equal:
      return {level_compare, BinaryOp::equal};
    case not_equal:
      return {level_compare, BinaryOp::not_equal};
    case plus:
      return {level_sum, BinaryOp::add};
    case minus:
      return {level_sum, BinaryOp::subtract};
    case star:
      return {level_product, BinaryOp::multiply};
    case slash:
      return {level_product, BinaryOp::divide};
    case percent:
      return {level_product, BinaryOp::modulo};
    default:
      return {};
  }
}

// Two operands' higher tree.
int higher(const ExprPtr& a, const ExprPtr& b) { return std::max<int>(a->height, b->height); }

}  // namespace

// condition ? if_true : if_false
ExprPtr Parser::expression() {
  const Level level(*this);
  if (!level) return nullptr;
  ExprPtr condition = binary(level_or);
  if (!condition || !accept(question)) return condition;
  ExprPtr if_true, if_false;
  {
    // Up to its `:` the middle is as if in brackets.
    const Restore plain(juxtaposed_, false);
    if_true = expression();
    if (!if_true || !expect(colon, "write `condition ? one : other`")) return nullptr;
  }
  if_false = expression();
  if (!if_false) return nullptr;
  const Span place = condition->span.to(if_false->span);
  const int below = std::max<int>(condition->height, higher(if_true, if_false));
  return make(place, ConditionalExpr{std::move(condition), std::move(if_true), std::move(if_false)},
              below);
}

// Operators of level `lowest` and above, left to right.
ExprPtr Parser::binary(int lowest) {
  ExprPtr left = prefix(lowest);
  while (left) {
    const Token& word = peek();
    const auto [level, op] = operator_of(word.kind);
    if (level < lowest || level == 0 || at_new_element()) return left;
    const Span op_span = span(take());
    ExprPtr right = binary(level + 1);
    if (!right) return nullptr;
    const Span place = left->span.to(right->span);
    const int below = higher(left, right);
    left = make(place, BinaryExpr{op, std::move(left), std::move(right), op_span}, below);
    if (left && level == level_compare && operator_of(peek().kind).level == level_compare) {
      report_chain(*left, peek());
      return nullptr;
    }
  }
  return left;
}

// not a
ExprPtr Parser::prefix(int lowest) {
  if (!at(kw_not)) return unary();
  if (lowest > level_not) {
    unexpected("a value", "put it in parentheses: `(not ...)`");
    return nullptr;
  }
  const Level level(*this);
  if (!level) return nullptr;
  const std::uint32_t begin = take().begin;
  ExprPtr operand = binary(level_not);
  if (!operand) return nullptr;
  const int below = operand->height;
  return make(since(begin), UnaryExpr{UnaryOp::logical_not, std::move(operand)}, below);
}

// -a
ExprPtr Parser::unary() {
  if (!at(minus)) return power();
  const Level level(*this);
  if (!level) return nullptr;
  const std::uint32_t begin = take().begin;
  ExprPtr operand = unary();
  if (!operand) return nullptr;
  const int below = operand->height;
  return make(since(begin), UnaryExpr{UnaryOp::negate, std::move(operand)}, below);
}

// a ^ b, from right to left
ExprPtr Parser::power() {
  ExprPtr base = postfix();
  if (!base || !at(TokenKind::power)) return base;
  const Level level(*this);
  if (!level) return nullptr;
  const Span op_span = span(take());
  ExprPtr exponent = unary();
  if (!exponent) return nullptr;
  const Span place = base->span.to(exponent->span);
  const int below = higher(base, exponent);
  return make(place, BinaryExpr{BinaryOp::power, std::move(base), std::move(exponent), op_span},
              below);
}

// f(a)  a[i]  a.b
ExprPtr Parser::postfix() {
  ExprPtr value = primary();
  while (value) {
    const bool apart = juxtaposed_ && peek().space_before;
    const bool named = std::holds_alternative<NameExpr>(value->node) ||
                       std::holds_alternative<MemberExpr>(value->node);
    if (at(left_paren) && named && !value->parenthesised && !apart) {
      value = call(std::move(value));
    } else if (at(left_bracket) && !apart && !at_metadata()) {
      value = index(std::move(value));
    } else if (at(dot) && std::holds_alternative<NumberExpr>(value->node) &&
               !value->parenthesised) {
      unexpected("an operator", "a number has no components");
      return nullptr;
    } else if (at(dot)) {
      value = member(std::move(value));
    } else {
      return value;
    }
  }
  return nullptr;
}

ExprPtr Parser::primary() {
  const Token& word = peek();
  switch (word.kind) {
    case TokenKind::number:
      return number();
    case string:
      take();
      return make(span(word), StringExpr{string_value(text(word))}, 0);
    case name:
      take();
      return make(span(word), NameExpr{std::string(text(word))}, 0);
    case kw_true:
      take();
      return make(span(word), BoolExpr{true}, 0);
    case kw_false:
      take();
      return make(span(word), BoolExpr{false}, 0);
    case left_paren:
      return parentheses();
    case left_bracket:
      return vector();
    default:
      report_missing_operand();
      return nullptr;
  }
}

ExprPtr Parser::number() {
  const Token& word = take();
  const double value = number_value(text(word));
  // Half a unit above the largest 32-bit number, where rounding goes to infinity.
  if (value >= 0x1.ffffffp127)
    diagnostics_.warning("number-too-large", span(word),
                         "this number is infinite: it is above 3.4e38",
                         "write `INF` if that is meant");
  return make(span(word), NumberExpr{value, std::string(text(word))}, 0);
}

// (a) or (a, b)
ExprPtr Parser::parentheses() {
  const Restore plain(juxtaposed_, false);
  const std::uint32_t begin = take().begin;
  std::vector<ExprPtr> elements;
  int below = 0;
  do {
    if (!element(elements, below)) return nullptr;
  } while (accept(comma));
  if (at(assign)) {
    report("assignment-in-condition", span(peek()),
           "`=` sets a value and cannot stand in an expression", "`==`", "write `==` to compare");
    return nullptr;
  }
  if (!expect(right_paren)) return nullptr;

  if (elements.size() > 1) return make(since(begin), TupleExpr{std::move(elements)}, below);
  ExprPtr inner = std::move(elements.front());
  inner->parenthesised = true;
  inner->span = since(begin);
  return inner;
}

bool Parser::element(std::vector<ExprPtr>& elements, int& below) {
  ExprPtr value = expression();
  if (!value) return false;
  below = std::max<int>(below, value->height);
  elements.push_back(std::move(value));
  return true;
}

// [a b]  [a, b]  [a .. b]
ExprPtr Parser::vector() {
  const Token& opener = take();
  const Restore inside(juxtaposed_, opener.juxtaposed);
  std::vector<ExprPtr> elements;
  int below = 0;
  while (!at(right_bracket)) {
    if (!element(elements, below)) return nullptr;
    if (elements.size() == 1 && at(dot_dot))
      return range(opener.begin, std::move(elements.front()));
    if (opener.juxtaposed || accept(comma)) continue;
    if (!at(right_bracket)) {
      unexpected("`,` or `]`", "separate all the elements by commas, or none of them");
      return nullptr;
    }
  }
  take();
  return make(since(opener.begin), VectorExpr{std::move(elements)}, below);
}

// [first .. last]  [first .. last by step]
ExprPtr Parser::range(std::uint32_t begin, ExprPtr first) {
  take();
  RangeExpr node{std::move(first), expression(), nullptr};
  if (!node.last) return nullptr;
  int below = higher(node.first, node.last);
  if (at_word("by")) {
    take();
    node.step = expression();
    if (!node.step) return nullptr;
    below = std::max<int>(below, node.step->height);
  }
  if (!expect(right_bracket, "a range is `[first .. last]` or `[first .. last by step]`"))
    return nullptr;
  return make(since(begin), std::move(node), below);
}

// f(a, name = b)
ExprPtr Parser::call(ExprPtr callee) {
  const Restore plain(juxtaposed_, false);
  const std::uint32_t begin = callee->span.begin;
  int below = callee->height;
  CallExpr node;
  node.callee = std::move(callee);
  take();
  while (!at(right_paren)) {
    if (!argument(node, below)) return nullptr;
    if (accept(comma)) continue;
    if (!at(right_paren)) {
      unexpected("`,` or `)`");
      return nullptr;
    }
  }
  take();
  return make(since(begin), std::move(node), below);
}

bool Parser::argument(CallExpr& call, int& below) {
  Argument argument;
  if (at(name) && peek(1).kind == assign) {
    const Token& word = take();
    argument.name = text(word);
    argument.name_span = span(word);
    take();
  }
  argument.value = expression();
  if (!argument.value) return false;
  below = std::max<int>(below, argument.value->height);
  call.arguments.push_back(std::move(argument));
  return true;
}

// a[i]  a[i, j]
ExprPtr Parser::index(ExprPtr base) {
  const bool juxtaposed = juxtaposed_;
  const Restore plain(juxtaposed_, false);
  const std::uint32_t begin = base->span.begin;
  int below = base->height;
  IndexExpr node;
  node.base = std::move(base);
  take();
  do {
    if (!element(node.indices, below)) return nullptr;
  } while (accept(comma));
  const std::string help = juxtaposed ? "put a blank before a `[` that begins a new row" : "";
  if (!expect(right_bracket, help)) return nullptr;
  return make(since(begin), std::move(node), below);
}

// a.b
ExprPtr Parser::member(ExprPtr base) {
  take();
  const Token& word = peek();
  if (!expect(name, "name a component, as in `p.x`, or a channel, as in `fg.color`"))
    return nullptr;
  const std::uint32_t begin = base->span.begin;
  const int below = base->height;
  return make(since(begin), MemberExpr{std::move(base), std::string(text(word)), span(word)},
              below);
}

bool Parser::at_new_element() const {
  return juxtaposed_ && at(minus) && peek().space_before && !peek(1).space_before;
}

// `[[ name =`, ` [[ name` or `[[ ]]` behind a value. An index in double brackets would be a vector,
// which none is.
bool Parser::at_metadata() const {
  if (!at(left_bracket) || peek(1).kind != left_bracket || peek(1).space_before) return false;
  const bool entry = peek(2).kind == name && (peek(3).kind == assign || peek().space_before);
  return entry || peek(2).kind == right_bracket;
}

// ---- Errors -------------------------------------------------------------------------------------

void Parser::report_missing_operand() {
  const TokenKind before = position_ > 0 ? words_.tokens[position_ - 1].kind : end;
  const bool adjacent = !peek().space_before;
  std::string help;
  if (at(assign) && operator_of(before).level >= level_sum) {
    help = "write the operator and `=` without a space, as in `+=`";
  } else if (at(assign) && before >= kw_function && before <= kw_not) {
    help = "choose another name: " + std::string(describe(before)) + " is a word of the language";
  } else if (at(plus) && before == plus && adjacent) {
    help = "write `+= 1`";
  } else if (at(plus)) {
    help = "leave out the `+`";
  } else if (at(newline) && operator_of(before).level > 0) {
    help = "put the whole expression in parentheses to continue it on the next line";
  }
  unexpected("an expression", help);
}

// `a < b < c`: the next word is the second comparison.
void Parser::report_chain(const Expr& left, const Token& op) {
  const auto& first = std::get<BinaryExpr>(left.node);
  std::string help = "join two comparisons with `and`";
  const std::string middle = quote(first.right->span);
  if (middle != "..." && quote(left.span) != "...")
    help = "write `" + quote(left.span) + " and " + middle + " " + std::string(text(op)) + " ...`";
  report("chained-comparison", span(op), "comparisons cannot be chained", {}, help);
}

}  // namespace pse::lang
