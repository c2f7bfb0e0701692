// Balancing brackets. A text in which every bracket has its partner is done in one pass. In any
// other, a pass that also looks at lines finds those without, and a last one ends each of them
// where the text goes back to its line's indentation.
#include "lang/layout.h"

#include <algorithm>
#include <string>
#include <utility>

namespace pse::lang {

namespace {

using enum TokenKind;

bool begins_statement(TokenKind kind) {
  switch (kind) {
    case kw_function:
    case kw_if:
    case kw_else:
    case kw_elif:
    case kw_while:
    case kw_for:
    case kw_return:
    case kw_break:
    case kw_continue:
    case kw_import:
    case kw_action:
      return true;
    default:
      return false;
  }
}

TokenKind partner(TokenKind kind) {
  if (kind == left_paren) return right_paren;
  if (kind == left_bracket) return right_bracket;
  return right_brace;
}

class Balancer {
 public:
  Balancer(const std::vector<Token>& tokens, const SourceFile& source, FileId file,
           Diagnostics& diagnostics)
      : tokens_(tokens),
        source_(source),
        file_(file),
        diagnostics_(diagnostics),
        unclosed_(tokens.size()) {}

  std::vector<Token> run() {
    pass();
    if (balanced_) return std::move(out_);
    mode_ = Mode::searching;
    pass();
    mode_ = Mode::repairing;
    pass();

    // Repairs may find another partner for a bracket; an error must be left of them all the same.
    const auto first = std::find(unclosed_.begin(), unclosed_.end(), true);
    if (first != unclosed_.end() && !reported_)
      report_unclosed({static_cast<std::size_t>(first - unclosed_.begin())}, tokens_.back(),
                      out_.back().end);
    return std::move(out_);
  }

 private:
  struct Open {
    std::size_t token = 0;     // the opening bracket
    std::size_t out = 0;       // its place in the result
    std::uint32_t indent = 0;  // of its line
    bool separated = false;    // has a comma or a `..` of its own
  };

  const std::vector<Token>& tokens_;
  const SourceFile& source_;
  FileId file_;
  Diagnostics& diagnostics_;
  enum class Mode { matching, searching, repairing } mode_ = Mode::matching;
  bool balanced_ = true;        // the first pass found every partner
  bool reported_ = false;       // an opening bracket without partner
  std::vector<bool> unclosed_;  // by token: an opening bracket without partner
  std::vector<Open> open_;
  std::vector<std::size_t> open_unclosed_;  // places in open_ of those that unclosed_ names
  std::size_t parens_ = 0, brackets_ = 0, braces_ = 0;
  std::vector<Token> out_;
  // Opening brackets without partner that have been ended before one word, the innermost first.
  struct Missing {
    std::vector<std::size_t> openers;
    Token before;
    std::uint32_t after = 0;  // where the last word in front of that one ends
    bool behind_open_text = false;
  } missing_;
  static constexpr std::size_t most_spelt = 8;

  std::size_t& count(TokenKind opener) {
    return opener == left_paren ? parens_ : opener == left_bracket ? brackets_ : braces_;
  }
  TokenKind top() const { return tokens_[open_.back().token].kind; }
  bool in_expression() const { return parens_ + brackets_ > 0; }
  Span span(const Token& token) const { return {file_, token.begin, token.end}; }

  // ---- One pass over the words ----

  void pass() {
    open_.clear(), out_.clear(), open_unclosed_.clear();
    parens_ = brackets_ = braces_ = 0;
    std::uint32_t indent = 0;
    for (std::size_t i = 0; i < tokens_.size(); ++i) {
      const Token& token = tokens_[i];
      report_missing();
      switch (token.kind) {
        case newline:
          indent = token.indent;
          start_line(i);
          break;
        case left_paren:
        case left_bracket:
          open(i, indent);
          break;
        case left_brace:
          while (in_expression()) close_missing(token);
          open(i, indent);
          break;
        case right_paren:
          close(token, left_paren);
          break;
        case right_bracket:
          close(token, left_bracket);
          break;
        case right_brace:
          while (in_expression()) close_missing(token);
          close(token, left_brace);
          break;
        case end:
          while (!open_.empty()) close_missing(token);
          out_.push_back(token);
          break;
        case comma:
        case dot_dot:
          if (!open_.empty()) open_.back().separated = true;
          [[fallthrough]];
        default:
          out_.push_back(token);
      }
    }
    report_missing();
  }

  // A line that sets a name, and begins no deeper than the line of the open bracket.
  bool looks_like_assignment(std::size_t line) const {
    if (line + 2 >= tokens_.size() || tokens_[line + 1].kind != name) return false;
    const TokenKind op = tokens_[line + 2].kind;
    return (op == assign || op == plus_assign || op == minus_assign || op == star_assign ||
            op == slash_assign || op == power_assign) &&
           tokens_[line].indent <= open_.back().indent;
  }

  void start_line(std::size_t line) {
    const Token &token = tokens_[line], &next = tokens_[line + 1];
    if (mode_ != Mode::matching && in_expression() && looks_like_assignment(line))
      while (in_expression()) close_missing(token);
    // An unclosed bracket ends where its line's indentation comes back.
    while (!open_unclosed_.empty() && open_[open_unclosed_.back()].indent >= token.indent &&
           next.kind != right_brace) {
      const std::size_t depth = open_unclosed_.back();
      while (open_.size() > depth) close_missing(token);
    }
    // Words that only begin statements end every expression.
    if (begins_statement(next.kind))
      while (in_expression()) close_missing(token);
    if (!in_expression()) out_.push_back(token);
  }

  void open(std::size_t i, std::uint32_t indent) {
    if (unclosed_[i]) open_unclosed_.push_back(open_.size());
    open_.push_back({i, out_.size(), indent});
    ++count(tokens_[i].kind);
    out_.push_back(tokens_[i]);
  }

  void close(const Token& token, TokenKind opener) {
    if (count(opener) == 0) {
      balanced_ = false;
      if (mode_ == Mode::searching) report_stray(token);
      // `(a]`: taken for the bracket that was meant.
      if (in_expression() && opener != left_brace) close_as(partner(top()), token);
      return;
    }
    while (top() != opener) close_missing(token);
    close_as(token.kind, token);
  }

  // The innermost bracket gets its end.
  void close_as(TokenKind kind, Token token) {
    pop();
    token.kind = kind;
    out_.push_back(token);
  }

  // The innermost bracket has no end in the text; one is put in behind the last word, before
  // `before`.
  void close_missing(const Token& before) {
    const std::size_t opener = open_.back().token;
    balanced_ = false;
    if (mode_ == Mode::searching) {
      unclosed_[opener] = true;
    } else if (mode_ == Mode::repairing && unclosed_[opener]) {
      if (missing_.openers.empty()) missing_ = {{}, before, out_.back().end, behind_open_text()};
      missing_.openers.push_back(opener);
    }
    const std::uint32_t at = out_.back().end;
    const TokenKind kind = partner(top());
    pop();
    out_.push_back({.kind = kind, .made_up = true, .begin = at, .end = at});
  }

  void pop() {
    const Open& opened = open_.back();
    if (top() == left_bracket) out_[opened.out].juxtaposed = !opened.separated;
    if (!open_unclosed_.empty() && open_unclosed_.back() == open_.size() - 1)
      open_unclosed_.pop_back();
    --count(top());
    open_.pop_back();
  }

  // ---- Reports ----

  // The last word is a text without closing quote, which may have swallowed the closing bracket.
  bool behind_open_text() const {
    const auto last =
        std::find_if(out_.rbegin(), out_.rend(), [](const Token& token) { return !token.made_up; });
    return last != out_.rend() && last->open;
  }

  // What was found to end at one place is one error, at the outermost bracket.
  void report_missing() {
    if (missing_.openers.empty()) return;
    const Missing missing = std::exchange(missing_, {});
    reported_ = true;
    if (!missing.behind_open_text) report_unclosed(missing.openers, missing.before, missing.after);
  }

  std::string line_of(const Token& token) const {
    return std::to_string(source_.position(token.begin).line);
  }

  // The innermost of `openers` comes first; they end behind `after`.
  void report_unclosed(const std::vector<std::size_t>& openers, const Token& before,
                       std::uint32_t after) {
    reported_ = true;
    if (diagnostics_.error_count() >= Diagnostics::give_up) return;
    const Token& opener = tokens_[openers.back()];
    std::string ends;
    for (std::size_t i = 0; i < openers.size() && i < most_spelt; ++i)
      ends += describe(partner(tokens_[openers[i]].kind)).substr(1, 1);
    ends = openers.size() > most_spelt ? "their partners" : "`" + ends + "`";
    std::string what = std::string(describe(opener.kind)) + " is never closed";
    if (const std::size_t more = openers.size() - 1)
      what += ", nor " +
              (more == 1 ? "is the bracket" : "are " + std::to_string(more) + " brackets") +
              " in it";
    std::string help = "add " + ends;
    if (before.kind == end)
      help += " after it";
    else if (line_of(before) == line_of(opener))
      help += " before " + std::string(describe(before.kind));
    else if (before.kind == newline &&
             source_.position(after).line == source_.position(opener.begin).line)
      help += " on this line";
    else
      help += " before line " + line_of(before);
    diagnostics_.add({Severity::error, "unclosed-bracket", what, span(opener), ends, help});
  }

  void report_stray(const Token& token) {
    if (diagnostics_.error_count() >= Diagnostics::give_up) return;
    if (in_expression() && token.kind != right_brace) {
      const Token& opener = tokens_[open_.back().token];
      diagnostics_.add({Severity::error,
                        "wrong-bracket",
                        std::string(describe(token.kind)) + " cannot close the " +
                            std::string(describe(opener.kind)) + " of line " + line_of(opener),
                        span(token),
                        std::string(describe(partner(opener.kind))),
                        {}});
    } else {
      diagnostics_.error("stray-bracket", span(token),
                         std::string(describe(token.kind)) + " closes nothing",
                         "remove it, or open the bracket before it");
    }
  }
};

}  // namespace

std::vector<Token> lay_out(const std::vector<Token>& tokens, const SourceFile& source, FileId file,
                           Diagnostics& diagnostics) {
  return Balancer(tokens, source, file, diagnostics).run();
}

}  // namespace pse::lang
