// The parser's inside: a recursive descent over the words, one method for each rule of
// docs/grammar.md. Its methods are spread over parse_expressions.cpp, parse_statements.cpp,
// parse_blocks.cpp and parse_actions.cpp.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "lang/parser.h"
#include "lang/tokens.h"

namespace pse::lang {

// How the lines of a block are held together.
struct Layout {
  bool braces = false;
  bool inside_braces =
      false;  // the block's head stands in a braced block: lines need not align there
  bool top_level = false;
  std::uint32_t column = 0;       // of an indented block: where its lines begin
  std::uint32_t head_column = 0;  // of an indented block: where its head's line begins
};

// A rule's method returns null, or false, after an error; the error is then reported already, and
// the statement's caller skips to where the next statement may begin.
class Parser {
 public:
  Parser(const SourceMap& sources, FileId file, TokenList words, Diagnostics& diagnostics,
         const ParseLimits& limits);

  Program program();
  ExprPtr lone_expression();

 private:
  // ---- Words (parser.cpp) ----
  const Token& peek(std::size_t ahead = 0) const;
  bool at(TokenKind kind) const { return peek().kind == kind; }
  bool at_word(std::string_view word) const { return at(TokenKind::name) && text(peek()) == word; }
  const Token& take();
  bool accept(TokenKind kind);
  // Takes a word of this kind, or reports that it is missing.
  bool expect(TokenKind kind, std::string suggestion = {});
  std::string_view text(const Token& token) const;
  Span span(const Token& token) const { return {file_, token.begin, token.end}; }
  Span since(std::uint32_t begin) const { return {file_, begin, std::max(begin, previous_end_)}; }
  // The source text of a place, shortened for a message.
  std::string quote(const Span& place) const;

  // ---- Errors and limits (parser.cpp) ----
  void report(std::string code, Span place, std::string message, std::string expected = {},
              std::string suggestion = {});
  // The next word is not what may stand here.
  void unexpected(std::string expected, std::string suggestion = {});
  // A closing bracket that the text lacks follows before the statement's end.
  bool in_unclosed_bracket() const;
  // Gives up: the rest of the text reads as its end.
  void stop(std::string code, Span place, std::string message, std::string suggestion);
  bool count_node(Span place);
  // One level of recursion; false when it is one too many.
  class Level {
   public:
    explicit Level(Parser& parser);
    ~Level() { --parser_.level_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    explicit operator bool() const { return !parser_.stopped_; }

   private:
    Parser& parser_;
  };

  // ---- Expressions (parse_expressions.cpp) ----
  ExprPtr expression();
  ExprPtr binary(int lowest);
  ExprPtr prefix(int lowest);
  ExprPtr unary();
  ExprPtr power();
  ExprPtr postfix();
  ExprPtr primary();
  ExprPtr number();
  ExprPtr parentheses();
  ExprPtr vector();
  ExprPtr range(std::uint32_t begin, ExprPtr first);
  ExprPtr call(ExprPtr callee);
  ExprPtr index(ExprPtr base);
  ExprPtr member(ExprPtr base);
  bool argument(CallExpr& call, int& below);
  bool element(std::vector<ExprPtr>& elements, int& below);
  // A new node over subtrees of which the highest is `below`; null when a limit is met.
  template <class Node>
  ExprPtr make(Span place, Node node, int below);
  void report_missing_operand();
  void report_chain(const Expr& left, const Token& op);
  // Where `[a -b]` begins a new element rather than subtracts.
  bool at_new_element() const;
  bool at_metadata() const;

  // ---- Statements (parse_statements.cpp) ----
  StmtPtr statement(const Layout& layout);
  StmtPtr foreign_statement(const Layout& layout);
  StmtPtr simple_statement();
  bool assignment(std::uint32_t begin, ExprPtr target, AssignOp op, StmtPtr& result);
  bool metadata(std::vector<MetaEntry>& entries);
  void check_knob(const AssignStmt& assign, Span place);
  StmtPtr if_statement(const Layout& layout);
  StmtPtr while_statement(const Layout& layout);
  StmtPtr for_statement(const Layout& layout);
  ExprPtr bare_range(ExprPtr first);
  StmtPtr return_statement();
  StmtPtr function_statement(const Layout& layout);
  StmtPtr import_statement();
  bool parameters(std::vector<Parameter>& list);
  ExprPtr condition();
  bool take_else(const Layout& layout, std::uint32_t column, bool after_statement);
  bool report_foreign_word();
  void check_top_level(const Token& word);
  template <class Node>
  StmtPtr make_statement(std::uint32_t begin, Node node);

  // ---- Actions (parse_actions.cpp) ----
  StmtPtr action_statement(const Layout& layout);
  bool at_movement() const;
  StmtPtr movement();

  // ---- Blocks and lines (parse_blocks.cpp) ----
  void statements(Block& block, const Layout& layout);
  bool next_line(const Layout& layout, std::uint32_t& tolerated);
  // What `head` governs; a missing block is no further error where the head was not understood.
  Block body(const Layout& layout, std::string_view head, bool understood);
  Block braced_block();
  void skip_statement();
  void skip_head();
  bool at_statement_end() const;
  // The reserved word that a line's first word may have been meant for.
  std::string meant_keyword() const;

  const SourceMap& sources_;
  FileId file_;
  TokenList words_;
  Diagnostics& diagnostics_;
  const ParseLimits& limits_;

  std::size_t position_ = 0;
  std::uint32_t previous_end_ = 0;  // where the last word taken ends
  std::uint32_t line_column_ = 0;   // where the current line begins
  std::size_t lines_ = 0;           // newlines taken
  std::size_t nodes_ = 0;
  int level_ = 0;   // of recursion
  int blocks_ = 0;  // open blocks
  std::size_t misplaced_ = 0;  // the last line whose column was reported: its first word
  bool stopped_ = false;
  bool failed_ = false;  // the statement before was not understood
  bool in_action_ = false;
  bool juxtaposed_ = false;  // directly inside a vector without commas
  std::string first_word_;   // of the statement before, when that was a call
};

// A set value that comes back at the end of the scope.
class Restore {
 public:
  Restore(bool& place, bool value) : place_(place), old_(std::exchange(place, value)) {}
  ~Restore() { place_ = old_; }
  Restore(const Restore&) = delete;
  Restore& operator=(const Restore&) = delete;

 private:
  bool& place_;
  bool old_;
};

template <class Node>
ExprPtr Parser::make(Span place, Node node, int below) {
  if (!count_node(place)) return nullptr;
  if (below >= limits_.max_height) {
    stop("expression-too-long", place,
         "this expression has more than " + std::to_string(limits_.max_height) +
             " operators in a row",
         "compute it in steps");
    return nullptr;
  }
  auto expr = std::make_unique<Expr>();
  expr->span = place;
  expr->node = std::move(node);
  expr->height = static_cast<std::uint16_t>(std::min(below + 1, 0xffff));
  return expr;
}

template <class Node>
StmtPtr Parser::make_statement(std::uint32_t begin, Node node) {
  const Span place = since(begin);
  if (!count_node(place)) return nullptr;
  auto statement = std::make_unique<Stmt>();
  statement->span = place;
  statement->node = std::move(node);
  return statement;
}

}  // namespace pse::lang
