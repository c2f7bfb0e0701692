// The words of a program: what the lexer makes and the parser reads. First arrow of the flow:
// text -> tokens.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "diag/source.h"
#include "lang/ast.h"

namespace pse::lang {

enum class TokenKind : std::uint8_t {
  end,
  newline,  // before the first word of each line that begins outside ( ) and [ ]
  invalid,  // bytes that are no word; the lexer has reported them
  number, string, name,
  // Reserved words. `in`, `as`, `by`, `then` and `add` are names that mean more in their place.
  kw_function, kw_if, kw_else, kw_elif, kw_while, kw_for, kw_return, kw_break, kw_continue,
  kw_import, kw_action, kw_true, kw_false, kw_and, kw_or, kw_not,
  // Brackets and separators.
  left_paren, right_paren, left_bracket, right_bracket, left_brace, right_brace,
  comma, semicolon, colon, question, dot, dot_dot,
  // Operators.
  plus, minus, star, slash, percent, power,
  less, less_equal, greater, greater_equal, equal, not_equal,
  assign, plus_assign, minus_assign, star_assign, slash_assign, power_assign
};

struct Token {
  TokenKind kind = TokenKind::end;
  bool space_before = false;  // white space, a comment or a line's start stands before it
  bool made_up = false;       // a closing bracket that the text lacks, put in to go on
  bool open = false;          // a text without closing quote; the lexer has reported it
  bool juxtaposed = false;    // a `[` without comma or `..` of its own: elements by white space
  std::uint32_t begin = 0, end = 0;
  std::uint32_t indent = 0;  // of a newline: the column, from 0, in which the next line begins
};

// The token's kind as a reader would write it: "`while`", "a number", "the end of the line".
std::string_view describe(TokenKind kind);

// The reserved word that `word` spells, or TokenKind::name.
TokenKind keyword(std::string_view word);

struct TokenList {
  std::vector<Token> tokens;  // ends with TokenKind::end
  std::vector<Comment> comments;
};

}  // namespace pse::lang
