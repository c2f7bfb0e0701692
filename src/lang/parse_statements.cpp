// Statements: docs/grammar.md, "Statements".
#include <algorithm>
#include <array>
#include <cctype>

#include "lang/parser_state.h"

namespace pse::lang {

namespace {

using enum TokenKind;

std::optional<AssignOp> assign_op(TokenKind kind) {
  switch (kind) {
    case assign:
      return AssignOp::set;
    case plus_assign:
      return AssignOp::add;
    case minus_assign:
      return AssignOp::subtract;
    case star_assign:
      return AssignOp::multiply;
    case slash_assign:
      return AssignOp::divide;
    case power_assign:
      return AssignOp::power;
    default:
      return std::nullopt;
  }
}

// A name with any number of `[i]` and `.member` behind it.
bool is_target(const Expr& expr) {
  const Expr* at = &expr;
  while (!at->parenthesised) {
    if (const auto* index = std::get_if<IndexExpr>(&at->node))
      at = index->base.get();
    else if (const auto* member = std::get_if<MemberExpr>(&at->node))
      at = member->base.get();
    else
      return std::holds_alternative<NameExpr>(at->node);
  }
  return false;
}

// First words of statements in other languages.
struct Foreign {
  std::string_view word, help;
};
constexpr auto foreign_words = std::to_array<Foreign>({
    {"def", "write `function`"},
    {"func", "write `function`"},
    {"fn", "write `function`"},
    {"fun", "write `function`"},
    {"proc", "write `function`"},
    {"sub", "write `function`"},
    {"unless", "write `if not`"},
    {"until", "write `while not`"},
    {"foreach", "write `for c in array`"},
    {"include", "write `import name`"},
    {"use", "write `import name`"},
    {"using", "write `import name`"},
    {"from", "write `import name`"},
    {"let", "leave it out: a name is set by `name = value`"},
    {"var", "leave it out: a name is set by `name = value`"},
    {"const", "leave it out: a name is set by `name = value`"},
    {"local", "leave it out: a name is set by `name = value`"},
    {"auto", "leave it out: a name is set by `name = value`"},
    {"float", "leave it out: types are found by the compiler"},
    {"double", "leave it out: types are found by the compiler"},
    {"int", "leave it out: types are found by the compiler"},
    {"bool", "leave it out: types are found by the compiler"},
    {"string", "leave it out: types are found by the compiler"},
    {"vector", "leave it out: types are found by the compiler"},
    {"vec2", "leave it out: types are found by the compiler"},
    {"vec3", "leave it out: types are found by the compiler"},
    {"vec4", "leave it out: types are found by the compiler"},
    {"void", "write `function`"},
});

}  // namespace

StmtPtr Parser::statement(const Layout& layout) {
  const std::uint32_t begin = peek().begin;
  switch (peek().kind) {
    case kw_if:
      return if_statement(layout);
    case kw_while:
      return while_statement(layout);
    case kw_for:
      return for_statement(layout);
    case kw_return:
      return return_statement();
    case kw_function:
      return function_statement(layout);
    case kw_import:
      return import_statement();
    case kw_action:
      return action_statement(layout);
    case kw_break:
      take();
      return make_statement(begin, BreakStmt{});
    case kw_continue:
      take();
      return make_statement(begin, ContinueStmt{});
    case kw_else:
    case kw_elif:
      if (position_ != misplaced_)
        report("else-without-if", span(peek()),
               std::string(describe(peek().kind)) + " has no `if`", {},
               "begin it in the column of its `if`, right behind the block of the `if`");
      return nullptr;
    case left_brace:
      if (!failed_) {
        const std::string meant = meant_keyword();
        report("block-without-head", span(peek()), "this block has no head",
               "`if`, `while`, `for`, `function` or `action`",
               meant.empty() ? "" : "did you mean `" + meant + "`?");
      }
      return nullptr;
    default:
      return foreign_statement(layout);
  }
}

// `def f(x)` and `float t = 1` are reported, and read as what they are meant for.
StmtPtr Parser::foreign_statement(const Layout& layout) {
  const bool foreign = report_foreign_word();
  if (!foreign) return simple_statement();
  const std::string_view word = text(peek());
  const auto known = std::ranges::find(foreign_words, word, &Foreign::word);
  if (known == foreign_words.end() || peek(1).kind != name) return nullptr;
  if (known->help == "write `function`" && peek(2).kind == left_paren)
    return function_statement(layout);
  if (known->help.starts_with("leave it out") && peek(2).kind == assign) {
    take();
    return simple_statement();
  }
  return nullptr;
}

// An assignment, a movement of an action, or an expression.
StmtPtr Parser::simple_statement() {
  if (in_action_ && at_movement()) return movement();

  const Token& first = peek();
  ExprPtr value = expression();
  if (!value) return nullptr;
  if (const auto op = assign_op(peek().kind)) {
    StmtPtr result;
    return assignment(first.begin, std::move(value), *op, result) ? std::move(result) : nullptr;
  }
  if (first.kind == name && std::holds_alternative<CallExpr>(value->node))
    first_word_ = quote(span(first));
  const auto* binary = std::get_if<BinaryExpr>(&value->node);
  if (binary && binary->op == BinaryOp::equal && !value->parenthesised)
    diagnostics_.warning("unused-comparison", binary->op_span, "this comparison is not used",
                         "write `=` to set a value");
  return make_statement(first.begin, ExprStmt{std::move(value)});
}

bool Parser::assignment(std::uint32_t begin, ExprPtr target, AssignOp op, StmtPtr& result) {
  if (!is_target(*target)) {
    report("bad-target", target->span, "this cannot be set", "a name, `name[i]` or `name.x`",
           std::holds_alternative<TupleExpr>(target->node) ? "set one name in each statement" : "");
    return false;
  }
  take();
  AssignStmt assign;
  assign.target = std::move(target);
  assign.op = op;
  assign.value = expression();
  if (!assign.value) return false;
  if (assign_op(peek().kind)) {
    unexpected("the end of the statement", "set one name in each statement");
    return false;
  }
  if (at_metadata()) {
    const Token& opener = peek();
    if (!metadata(assign.meta)) return false;
    check_knob(assign, span(opener));
  }
  result = make_statement(begin, std::move(assign));
  return result != nullptr;
}

// [[ min = 0, max = 1 ]]
bool Parser::metadata(std::vector<MetaEntry>& entries) {
  take(), take();
  while (!at(right_bracket)) {
    const Token& word = peek();
    if (!expect(name, "metadata are `name = value`, set apart by commas")) return false;
    if (!expect(assign, "metadata are `name = value`, set apart by commas")) return false;
    ExprPtr value = expression();
    if (!value) return false;
    entries.push_back({std::string(text(word)), span(word), std::move(value)});
    if (accept(comma)) continue;
    if (!at(right_bracket)) {
      unexpected("`,` or `]]`", "set metadata apart by commas");
      return false;
    }
  }
  take();
  return expect(right_bracket, "metadata end with `]]`");
}

void Parser::check_knob(const AssignStmt& assign, Span place) {
  const auto* target = std::get_if<NameExpr>(&assign.target->node);
  const bool capitalised = target && target->name[0] >= 'A' && target->name[0] <= 'Z';
  if (capitalised && assign.op == AssignOp::set && blocks_ == 0) return;
  if (target && !capitalised && assign.op == AssignOp::set && blocks_ == 0) {
    std::string name = target->name;
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    report("metadata-place", assign.target->span,
           "only a knob has metadata, and a knob is capitalised", {}, "write `" + name + "`");
    return;
  }
  report("metadata-place", place, "only a knob has metadata", {},
         "a knob is a capitalised name that is set at top level, as `Radius = 0.4 [[ min = 0 ]]`");
}

// if c ... else if c ... else ...
StmtPtr Parser::if_statement(const Layout& layout) {
  const std::uint32_t begin = peek().begin;
  const std::uint32_t column = line_column_;
  IfStmt node;
  std::uint32_t head = begin;
  while (true) {
    take();
    IfBranch branch;
    branch.condition = condition();
    branch.head = since(head);
    branch.body = body(layout, "if", branch.condition != nullptr);
    node.branches.push_back(std::move(branch));

    // Another branch, on this line or the next; `else if` is a branch like any other, however many
    // there are.
    if (!take_else(layout, column, node.branches.back().body.same_line)) break;
    head = peek().begin;
    if (at(kw_else) && peek(1).kind != kw_if) {
      take();
      IfBranch otherwise;
      otherwise.head = since(head);
      otherwise.body = body(layout, "else", true);
      node.branches.push_back(std::move(otherwise));
      break;
    }
    if (at(kw_else)) take();
  }
  return make_statement(begin, std::move(node));
}

// Goes to the `else`, `elif` or misspelt `elseif` that belongs to an `if` which began in `column`,
// if there is one.
bool Parser::take_else(const Layout& layout, std::uint32_t column, bool after_statement) {
  std::size_t ahead = 0;
  if (after_statement && peek(ahead).kind == semicolon) ++ahead;
  if (peek(ahead).kind == newline) {
    if (!layout.braces && peek(ahead).indent != column) return false;
    ++ahead;
  }
  const Token& word = peek(ahead);
  const std::string_view spelling = word.kind == name ? text(word) : std::string_view();
  const bool misspelt = spelling == "elseif" || spelling == "elsif";
  if (word.kind != kw_else && word.kind != kw_elif && !misspelt) return false;
  if (misspelt)
    report("unknown-word", span(word), "there is no `" + std::string(spelling) + "`", {},
           "write `else if` or `elif`");
  for (; ahead > 0; --ahead) take();
  return true;
}

StmtPtr Parser::while_statement(const Layout& layout) {
  const std::uint32_t begin = take().begin;
  WhileStmt node;
  node.condition = condition();
  node.body = body(layout, "while", node.condition != nullptr);
  return make_statement(begin, std::move(node));
}

// The condition of `if` and `while`. After an error the rest of the head is skipped, so that the
// body is read.
ExprPtr Parser::condition() {
  ExprPtr value = expression();
  if (value && at(assign)) {
    report("assignment-in-condition", span(peek()),
           "`=` sets a value and cannot stand in a condition", "`==`", "write `==` to compare");
    value = nullptr;
  }
  if (!value) skip_head();
  return value;
}

// for x in sequence
StmtPtr Parser::for_statement(const Layout& layout) {
  const std::uint32_t begin = take().begin;
  ForStmt node;
  const Token& word = peek();
  if (expect(name, "write `for i in [1 .. n]`")) {
    node.variable = text(word);
    node.variable_span = span(word);
    if (at_word("in")) {
      take();
      node.sequence = expression();
      if (node.sequence && at(dot_dot)) node.sequence = bare_range(std::move(node.sequence));
    } else {
      unexpected("`in`", "write `for i in [1 .. n]`");
    }
  }
  if (!node.sequence) skip_head();
  node.body = body(layout, "for", node.sequence != nullptr);
  return make_statement(begin, std::move(node));
}

// `for i in 1 .. n`: a range without its brackets.
ExprPtr Parser::bare_range(ExprPtr first) {
  const std::uint32_t begin = first->span.begin;
  take();
  ExprPtr last = expression();
  if (!last) return nullptr;
  const Span place = since(begin);
  report("unexpected-word", place, "a range stands in brackets", {},
         "write `[" + quote(place) + "]`");
  const int below = std::max(first->height, last->height);
  return make(place, RangeExpr{std::move(first), std::move(last), nullptr}, below);
}

StmtPtr Parser::return_statement() {
  const std::uint32_t begin = take().begin;
  ReturnStmt node;
  if (!at_statement_end()) {
    node.value = expression();
    if (!node.value) return nullptr;
  }
  return make_statement(begin, std::move(node));
}

// function f(a, b = 2) ...
StmtPtr Parser::function_statement(const Layout& layout) {
  check_top_level(peek());
  const std::uint32_t begin = take().begin;
  FunctionStmt node;
  const Token& word = peek();
  bool understood = expect(name, "write `function name(a, b)`");
  if (understood) {
    node.name = text(word);
    node.name_span = span(word);
    understood = parameters(node.parameters);
  }
  if (!understood) skip_head();
  node.head = since(begin);
  const Restore outside(in_action_, false);
  node.body = body(layout, "function", understood);
  return make_statement(begin, std::move(node));
}

bool Parser::parameters(std::vector<Parameter>& list) {
  if (!expect(left_paren, "write the parameters in parentheses, `()` when there are none"))
    return false;
  while (!at(right_paren)) {
    const Token& word = peek();
    if (!expect(name, "a parameter is a name, or `name = value`")) return false;
    Parameter parameter{std::string(text(word)), span(word), nullptr};
    if (accept(assign)) {
      parameter.default_value = expression();
      if (!parameter.default_value) return false;
    }
    list.push_back(std::move(parameter));
    if (accept(comma)) continue;
    if (!at(right_paren)) {
      unexpected("`,` or `)`",
                 at(name) ? "parameters have no types; set them apart by commas" : "");
      return false;
    }
  }
  take();
  return true;
}

// import module  /  import module as alias
StmtPtr Parser::import_statement() {
  check_top_level(peek());
  const std::uint32_t begin = take().begin;
  ImportStmt node;
  const Token& word = peek();
  if (!expect(name, "write the module's name without quotes: `import marble` reads marble.pse"))
    return nullptr;
  node.module = text(word);
  node.module_span = span(word);
  if (at_word("as")) {
    take();
    const Token& alias = peek();
    if (!expect(name, "write `import module as name`")) return nullptr;
    node.alias = text(alias);
  }
  return make_statement(begin, std::move(node));
}

void Parser::check_top_level(const Token& word) {
  if (blocks_ == 0) return;
  const std::string what(describe(word.kind));
  report("not-at-top-level", span(word), what + " cannot stand inside a block", {},
         "move it to the top level");
}

// `def f(x)`, `let x = 1`, `whille x < 1`: two words in a row, the first of which begins no
// statement here.
bool Parser::report_foreign_word() {
  if (!at(name)) return false;
  const std::string_view word = text(peek());
  const TokenKind next = peek(1).kind;
  const bool two_words =
      next == name || next == TokenKind::number || next == string || next == kw_not;
  const bool misspelt_else = word == "elseif" || word == "elsif";
  if (!misspelt_else && !two_words) return false;

  std::string help = misspelt_else ? "write `else if` or `elif`, in the column of its `if`" : "";
  for (const Foreign& foreign : foreign_words)
    if (foreign.word == word) help = foreign.help;
  if (help.empty()) {
    first_word_ = quote(span(peek()));
    const std::string meant = meant_keyword();
    if (!meant.empty()) help = "did you mean `" + meant + "`?";
  }
  // In an action `name amount` mixes another action in.
  if (help.empty() && in_action_) return false;
  if (!misspelt_else && in_action_ && next != name) return false;
  report("unknown-word", span(peek()), "`" + quote(span(peek())) + "` begins no statement", {},
         help);
  return true;
}

}  // namespace pse::lang
