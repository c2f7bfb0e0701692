// How each kind of word is written.
#include "lang/tokens.h"

#include <array>
#include <utility>

namespace pse::lang {

namespace {

using enum TokenKind;

constexpr std::array<std::pair<TokenKind, std::string_view>, 16> keywords = {{
    {kw_function, "function"},
    {kw_if, "if"},
    {kw_else, "else"},
    {kw_elif, "elif"},
    {kw_while, "while"},
    {kw_for, "for"},
    {kw_return, "return"},
    {kw_break, "break"},
    {kw_continue, "continue"},
    {kw_import, "import"},
    {kw_action, "action"},
    {kw_true, "true"},
    {kw_false, "false"},
    {kw_and, "and"},
    {kw_or, "or"},
    {kw_not, "not"},
}};

}  // namespace

std::string_view describe(TokenKind kind) {
  switch (kind) {
    case end:
      return "the end of the text";
    case newline:
      return "the end of the line";
    case invalid:
      return "an unknown character";
    case number:
      return "a number";
    case string:
      return "a text";
    case name:
      return "a name";
    case kw_function:
      return "`function`";
    case kw_if:
      return "`if`";
    case kw_else:
      return "`else`";
    case kw_elif:
      return "`elif`";
    case kw_while:
      return "`while`";
    case kw_for:
      return "`for`";
    case kw_return:
      return "`return`";
    case kw_break:
      return "`break`";
    case kw_continue:
      return "`continue`";
    case kw_import:
      return "`import`";
    case kw_action:
      return "`action`";
    case kw_true:
      return "`true`";
    case kw_false:
      return "`false`";
    case kw_and:
      return "`and`";
    case kw_or:
      return "`or`";
    case kw_not:
      return "`not`";
    case left_paren:
      return "`(`";
    case right_paren:
      return "`)`";
    case left_bracket:
      return "`[`";
    case right_bracket:
      return "`]`";
    case left_brace:
      return "`{`";
    case right_brace:
      return "`}`";
    case comma:
      return "`,`";
    case semicolon:
      return "`;`";
    case colon:
      return "`:`";
    case question:
      return "`?`";
    case dot:
      return "`.`";
    case dot_dot:
      return "`..`";
    case plus:
      return "`+`";
    case minus:
      return "`-`";
    case star:
      return "`*`";
    case slash:
      return "`/`";
    case percent:
      return "`%`";
    case power:
      return "`^`";
    case less:
      return "`<`";
    case less_equal:
      return "`<=`";
    case greater:
      return "`>`";
    case greater_equal:
      return "`>=`";
    case equal:
      return "`==`";
    case not_equal:
      return "`!=`";
    case assign:
      return "`=`";
    case plus_assign:
      return "`+=`";
    case minus_assign:
      return "`-=`";
    case star_assign:
      return "`*=`";
    case slash_assign:
      return "`/=`";
    case power_assign:
      return "`^=`";
  }
  return "a word";
}

TokenKind keyword(std::string_view word) {
  for (const auto& [kind, spelling] : keywords)
    if (spelling == word) return kind;
  return name;
}

}  // namespace pse::lang
