// Blocks and lines: which statements belong together, and where to go on after an error.
// docs/grammar.md, "Blocks".
#include "lang/parser_state.h"

namespace pse::lang {

namespace {

using enum TokenKind;

}  // namespace

// The statements of a block, up to the `}` or the line that ends it.
void Parser::statements(Block& block, const Layout& layout) {
  std::uint32_t tolerated = layout.column;  // a wrong column that was reported once
  while (true) {
    while (accept(semicolon) || (in_action_ && accept(comma))) {
    }
    if (at(end) || at(right_brace)) return;
    if (at(newline)) {
      if (!next_line(layout, tolerated)) return;
      continue;
    }

    // One statement; after an error, the rest of its line is skipped.
    const std::size_t start = position_;
    if (!at(left_brace)) first_word_.clear();
    StmtPtr next = statement(layout);
    failed_ = next == nullptr;
    if (next) {
      block.statements.push_back(std::move(next));
      const bool closed = words_.tokens[position_ - 1].kind == right_brace;
      if (!at_statement_end() && !closed && !(at(left_brace) && !first_word_.empty())) {
        std::string help = "begin a new line, or set the statements apart by `;`";
        const TokenKind before = words_.tokens[position_ - 1].kind;
        const bool factor = before == TokenKind::number || before == right_paren;
        const bool sets = peek(1).kind >= assign;
        if (at(left_paren) || (factor && !sets && (at(name) || at(TokenKind::number))))
          help = "write `*` to multiply";
        if (at(question)) help = "write `condition ? one : other`";
        unexpected("the end of the statement", help);
        failed_ = true;
      }
    }
    if (failed_) skip_statement();
    if (position_ == start && !at(end)) take();
  }
}

// Goes to the next line of the block; false when that line belongs to a block outside.
bool Parser::next_line(const Layout& layout, std::uint32_t& tolerated) {
  const Token& line = peek();
  const std::uint32_t column = line.indent;
  const Span place = span(words_.tokens[position_ + 1]);
  const bool right = layout.braces || column == layout.column;
  if (right) {
    tolerated = layout.column;
  } else if (column != tolerated || layout.column == tolerated) {
    if (column < layout.column) {
      if (!layout.top_level && (column <= layout.head_column || layout.inside_braces)) return false;
      const std::string columns =
          std::to_string(layout.column) +
          (layout.top_level ? "" : " or " + std::to_string(layout.head_column));
      report("unbalanced-indentation", place,
             "this line is indented by " + std::to_string(column) + ", as no line above it",
             "an indentation of " + columns);
      misplaced_ = position_ + 1;
    } else if (!failed_) {
      const std::string meant = meant_keyword();
      report("unexpected-indentation", place,
             "this line is indented deeper, but the line above begins no block",
             "an indentation of " + std::to_string(layout.column),
             meant.empty() ? "" : "did you mean `" + meant + "` in the line above?");
    }
    tolerated = column;
  }
  take();
  return true;
}

// What a head governs: `{ ... }`, deeper lines, or one statement on the same line.
Block Parser::body(const Layout& outer, std::string_view head, bool understood) {
  Block block;
  const Level level(*this);
  if (!level) return block;
  ++blocks_;
  if (!accept(colon) && at_word("then")) take();
  if (at(newline) && peek(1).kind == left_brace) take();
  if (at(left_brace)) {
    block = braced_block();
  } else if (at(newline) && peek().indent > line_column_) {
    Layout inner{
        .inside_braces = outer.braces, .column = peek().indent, .head_column = line_column_};
    take();
    const std::uint32_t begin = peek().begin;
    failed_ = false;
    statements(block, inner);
    block.span = since(begin);
    // Lines with nothing but `;`.
    if (block.empty() && !failed_)
      report("missing-block", span(peek()), "`" + std::string(head) + "` has an empty block",
             "a statement", "write `{ }` for a block that does nothing");
  } else if (at_statement_end() && !understood) {
    // The head's own error has been reported.
  } else if (at_statement_end()) {
    const Span place{file_, previous_end_, previous_end_};
    report("missing-block", place, "`" + std::string(head) + "` has no block",
           "an indented line, or `{`", "indent the lines that belong to it");
  } else {
    // Only one statement follows on the head's line; what comes after `;` is outside.
    block.same_line = true;
    const std::uint32_t begin = peek().begin;
    StmtPtr only = statement(outer);
    failed_ = only == nullptr;
    if (only)
      block.statements.push_back(std::move(only));
    else
      skip_statement();
    block.span = since(begin);
    if (at(semicolon) && peek(1).kind != newline && peek(1).kind != end &&
        peek(1).kind != right_brace && peek(1).kind != kw_else && peek(1).kind != kw_elif)
      diagnostics_.warning(
          "one-statement-body", span(peek(1)),
          "this statement does not belong to the `" + std::string(head) + "` before it",
          "put both into `{ }`, or on lines of their own");
  }
  --blocks_;
  return block;
}

Block Parser::braced_block() {
  Block block;
  block.braces = true;
  const std::size_t lines = lines_;
  const std::uint32_t begin = take().begin;
  statements(block, Layout{.braces = true});
  accept(right_brace);
  block.same_line = lines_ == lines;
  block.span = since(begin);
  failed_ = false;
  return block;
}

// After an error: to the end of the statement, reading the block that may follow it for its own
// errors.
void Parser::skip_statement() {
  const Restore plain(juxtaposed_, false);
  while (!at(newline) && !at(semicolon) && !at(right_brace) && !at(end)) {
    if (at(left_brace)) {
      const Level level(*this);
      if (!level) return;
      ++blocks_;
      braced_block();
      --blocks_;
      failed_ = true;
      return;
    }
    take();
  }
}

// After an error in a head: to its body.
void Parser::skip_head() {
  int depth = 0;
  while (!at(newline) && !at(left_brace) && !at(right_brace) && !at(end)) {
    if (depth == 0 && (at(colon) || at(semicolon))) return;
    if (at(left_paren) || at(left_bracket)) ++depth;
    if (at(right_paren) || at(right_bracket)) --depth;
    take();
  }
}

bool Parser::at_statement_end() const {
  return at(newline) || at(semicolon) || at(right_brace) || at(end) || (in_action_ && at(comma));
}

std::string Parser::meant_keyword() const {
  return nearest_name(first_word_, {"function", "if", "else", "elif", "while", "for", "return",
                                    "import", "action"});
}

}  // namespace pse::lang
