// The parser's entry, its walk over the words, and what all its rules share: errors and limits.
#include "lang/parser.h"

#include <algorithm>

#include "lang/lexer.h"
#include "lang/parser_state.h"

namespace pse::lang {

Parser::Parser(const SourceMap& sources, FileId file, TokenList words, Diagnostics& diagnostics,
               const ParseLimits& limits)
    : sources_(sources),
      file_(file),
      words_(std::move(words)),
      diagnostics_(diagnostics),
      limits_(limits) {}

// ---- Words --------------------------------------------------------------------------------------

const Token& Parser::peek(std::size_t ahead) const {
  return words_.tokens[std::min(position_ + ahead, words_.tokens.size() - 1)];
}

const Token& Parser::take() {
  const Token& token = peek();
  if (token.kind == TokenKind::newline) {
    line_column_ = token.indent;
    ++lines_;
  } else if (token.kind != TokenKind::end) {
    previous_end_ = token.end;
  }
  position_ = std::min(position_ + 1, words_.tokens.size() - 1);
  return token;
}

bool Parser::accept(TokenKind kind) {
  if (!at(kind)) return false;
  take();
  return true;
}

bool Parser::expect(TokenKind kind, std::string suggestion) {
  if (accept(kind)) return true;
  unexpected(std::string(describe(kind)), std::move(suggestion));
  return false;
}

std::string_view Parser::text(const Token& token) const { return sources_.text(span(token)); }

std::string Parser::quote(const Span& place) const {
  constexpr std::size_t longest = 40;
  const std::string_view whole = sources_.text(place);
  if (whole.size() > longest || whole.find('\n') != std::string_view::npos) return "...";
  return std::string(whole);
}

// ---- Errors and limits --------------------------------------------------------------------------

void Parser::report(std::string code, Span place, std::string message, std::string expected,
                    std::string suggestion) {
  if (stopped_ || diagnostics_.error_count() >= Diagnostics::give_up) return;
  diagnostics_.add({Severity::error, std::move(code), std::move(message), place,
                    std::move(expected), std::move(suggestion)});
}

void Parser::unexpected(std::string expected, std::string suggestion) {
  const Token& token = peek();
  // The lexer has spoken of these, and of the bracket that has swallowed what follows it.
  if (token.kind == TokenKind::invalid || in_unclosed_bracket()) return;

  // What is missing at the end of a line is missing behind its last word.
  Span place = span(token);
  std::string message = "unexpected " + std::string(describe(token.kind));
  if (token.kind == TokenKind::name || token.kind == TokenKind::number)
    message = "unexpected `" + quote(place) + "`";
  if (token.kind == TokenKind::newline || token.kind == TokenKind::end) {
    place = {file_, previous_end_, previous_end_};
    message = token.kind == TokenKind::end ? "the text ends too early" : "the line ends too early";
  }
  report("unexpected-word", place, std::move(message), std::move(expected), std::move(suggestion));
}

bool Parser::in_unclosed_bracket() const {
  for (std::size_t i = position_;; ++i) {
    const Token& token = words_.tokens[i];
    if (token.made_up) return true;
    if (token.kind == TokenKind::newline || token.kind == TokenKind::end) return false;
  }
}

void Parser::stop(std::string code, Span place, std::string message, std::string suggestion) {
  report(std::move(code), place, std::move(message), {}, std::move(suggestion));
  stopped_ = true;
  position_ = words_.tokens.size() - 1;
}

bool Parser::count_node(Span place) {
  if (stopped_) return false;
  if (++nodes_ <= limits_.max_nodes) return true;
  stop("program-too-large", place,
       "the program has more than " + std::to_string(limits_.max_nodes) +
           " expressions and statements",
       "divide it into modules");
  return false;
}

Parser::Level::Level(Parser& parser) : parser_(parser) {
  if (++parser_.level_ <= parser_.limits_.max_nesting) return;
  if (parser_.in_unclosed_bracket()) parser_.stopped_ = true;
  parser_.stop("nested-too-deep", parser_.span(parser_.peek()),
               "brackets, blocks and operators are nested more than " +
                   std::to_string(parser_.limits_.max_nesting) + " levels deep",
               "compute it in steps, or move the inner part into a function");
}

// ---- Entry --------------------------------------------------------------------------------------

Program Parser::program() {
  Program program;
  program.file = file_;
  Layout layout{.top_level = true};
  if (at(TokenKind::newline)) layout.column = peek().indent;
  statements(program.body, layout);
  program.comments = std::move(words_.comments);
  return program;
}

ExprPtr Parser::lone_expression() {
  accept(TokenKind::newline);
  ExprPtr value = expression();
  if (value && !at(TokenKind::end)) {
    unexpected("the end of the expression");
    return nullptr;
  }
  return value;
}

namespace {

bool check_size(const SourceMap& sources, FileId file, Diagnostics& diagnostics,
                const ParseLimits& limits) {
  if (sources.file(file).text.size() <= limits.max_bytes) return true;
  diagnostics.error("file-too-large", {file, 0, 0},
                    "the text is longer than " + std::to_string(limits.max_bytes) + " bytes",
                    "divide it into modules");
  return false;
}

}  // namespace

Program parse(const SourceMap& sources, FileId file, Diagnostics& diagnostics,
              const ParseLimits& limits) {
  Program nothing;
  nothing.file = file;
  if (!check_size(sources, file, diagnostics, limits)) return nothing;
  return Parser(sources, file, lex(sources, file, diagnostics), diagnostics, limits).program();
}

ExprPtr parse_expression(const SourceMap& sources, FileId file, Diagnostics& diagnostics) {
  const ParseLimits limits;
  if (!check_size(sources, file, diagnostics, limits)) return nullptr;
  const std::size_t before = diagnostics.error_count();
  ExprPtr value =
      Parser(sources, file, lex(sources, file, diagnostics), diagnostics, limits).lone_expression();
  return diagnostics.error_count() == before ? std::move(value) : nullptr;
}

}  // namespace pse::lang
