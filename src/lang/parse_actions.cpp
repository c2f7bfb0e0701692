// Actions and their movements, as chapter 12 of "Texturing & Modeling" prints them ("Painting with
// Actions").
#include "lang/parser_state.h"

namespace pse::lang {

namespace {

using enum TokenKind;

}  // namespace

// action name { ... }
StmtPtr Parser::action_statement(const Layout& layout) {
  check_top_level(peek());
  const std::uint32_t begin = take().begin;
  ActionStmt node;
  const Token& word = peek();
  if (expect(name, "write `action name { ... }`")) {
    node.name = text(word);
    node.name_span = span(word);
  } else {
    skip_head();
  }
  const Restore inside(in_action_, true);
  node.body = body(layout, "action", !node.name.empty());
  return make_statement(begin, std::move(node));
}

// `(MOVE, ...`, `add (MOVE, ...` or `name amount`.
bool Parser::at_movement() const {
  if (at(left_paren)) return peek(1).kind == name && peek(2).kind == comma;
  if (!at(name)) return false;
  if (text(peek()) == "add" && peek(1).kind == left_paren) return true;
  switch (peek(1).kind) {
    case TokenKind::number:
    case name:
      return true;
    case minus:
      return peek(1).space_before && !peek(2).space_before;
    case left_paren:
      return peek(1).space_before;
    default:
      return false;
  }
}

StmtPtr Parser::movement() {
  const std::uint32_t begin = peek().begin;
  MovementStmt node;
  node.kind = at(left_paren) ? MovementKind::set : MovementKind::mix;
  if (at(name) && text(peek()) == "add" && peek(1).kind == left_paren) {
    node.kind = MovementKind::add;
    take();
  }

  // (MOVE, value)
  const bool pair = node.kind != MovementKind::mix;
  const std::string form =
      node.kind == MovementKind::add ? "write `add (MOVE, value)`" : "write `(MOVE, value)`";
  if (pair) take();
  const Token& word = peek();
  if (!expect(name, pair ? form : "")) return nullptr;
  node.movement = text(word);
  node.movement_span = span(word);
  if (pair && !expect(comma, form)) return nullptr;
  node.value = expression();
  if (!node.value) return nullptr;
  if (pair && !expect(right_paren, form)) return nullptr;
  return make_statement(begin, std::move(node));
}

}  // namespace pse::lang
