// `pse fmt`: statements in pse's one layout. Four columns for each block; a block keeps its braces,
// or its place on the head's line, where it was written so and fits; comments and single blank
// lines stay where they were.
#include <array>

#include "lang/format_state.h"
#include "lang/parser.h"

namespace pse::lang {

namespace {

constexpr std::array assign_spellings = {" = ", " += ", " -= ", " *= ", " /= ", " ^= "};

bool is_simple(const Stmt& statement) {
  return std::holds_alternative<AssignStmt>(statement.node) ||
         std::holds_alternative<ExprStmt>(statement.node) ||
         std::holds_alternative<ReturnStmt>(statement.node) ||
         std::holds_alternative<BreakStmt>(statement.node) ||
         std::holds_alternative<ContinueStmt>(statement.node) ||
         std::holds_alternative<MovementStmt>(statement.node) ||
         std::holds_alternative<ImportStmt>(statement.node);
}

bool begins_with_keyword(const Stmt& statement) {
  return std::holds_alternative<ReturnStmt>(statement.node) ||
         std::holds_alternative<BreakStmt>(statement.node) ||
         std::holds_alternative<ContinueStmt>(statement.node);
}

class Formatter {
 public:
  Formatter(const Program& program, const SourceFile& source)
      : program_(program), source_(source), expressions_(source) {}

  std::string run() {
    const auto end = static_cast<std::uint32_t>(source_.text.size());
    statements(program_.body, 0, end);
    comments_before(end, 0);
    return std::move(out_);
  }

 private:
  const Program& program_;
  const SourceFile& source_;
  ExpressionFormatter expressions_;
  std::string out_;
  std::size_t comment_ = 0;     // the next to be printed
  std::uint32_t last_end_ = 0;  // in the source: where what was printed last ends
  bool fresh_block_ = true;     // nothing printed yet in this block

  // ---- Lines ----

  int line_of(std::uint32_t offset) const { return source_.position(offset).line; }

  void indent_to(std::size_t indent) { out_.append(indent, ' '); }

  // A blank line, where the program has one or more before `begin`.
  void blank_line(std::uint32_t begin) {
    if (!fresh_block_ && line_of(begin) - line_of(last_end_) > 1) out_ += '\n';
    fresh_block_ = false;
  }

  // ---- Comments ----

  bool comment_before(std::uint32_t offset) const {
    return comment_ < program_.comments.size() && program_.comments[comment_].span.begin < offset;
  }

  std::string comment_text(const Comment& comment) const {
    std::string text =
        source_.text.substr(comment.span.begin, comment.span.end - comment.span.begin);
    for (char& c : text)
      if (c == '\r' || c == '\f' || c == '\v') c = ' ';
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.pop_back();
    return text;
  }

  // The comments that begin before `offset`, on lines of their own.
  void comments_before(std::uint32_t offset, std::size_t indent) {
    while (comment_before(offset)) own_line_comment(indent);
  }

  void own_line_comment(std::size_t indent) {
    const Comment& comment = program_.comments[comment_++];
    blank_line(comment.span.begin);
    indent_to(indent);
    out_ += comment_text(comment) + "\n";
    last_end_ = comment.span.end;
  }

  // At the end of an indented block: the comments that stand deeper than the block's head, up to
  // `limit`.
  void comments_inside(std::uint32_t limit, std::uint32_t head_column, std::size_t indent) {
    while (comment_before(limit) && column_of(program_.comments[comment_].span.begin) > head_column)
      own_line_comment(indent);
  }

  // The column, from 0, of a place in the source.
  std::uint32_t column_of(std::uint32_t offset) const {
    std::uint32_t column = 0;
    for (std::uint32_t at = source_.line_starts[static_cast<std::size_t>(line_of(offset)) - 1];
         at < offset; ++at)
      column += source_.text[at] == '\t' ? 8 - column % 8 : 1;
    return column;
  }

  // Where the first word of the place's line stands.
  std::uint32_t line_column(std::uint32_t offset) const {
    std::uint32_t at = source_.line_starts[static_cast<std::size_t>(line_of(offset)) - 1];
    if (at == 0 && source_.text.starts_with("\xef\xbb\xbf")) at = 3;
    while (at < offset &&
           (source_.text[at] == ' ' || source_.text[at] == '\t' || source_.text[at] == '\r' ||
            source_.text[at] == '\f' || source_.text[at] == '\v'))
      ++at;
    return column_of(at);
  }

  // The comment behind a statement or a head that ends at `end`, when it stands on the same line
  // and before `limit`.
  void end_line(std::uint32_t end, std::uint32_t limit) {
    last_end_ = std::max(last_end_, end);
    if (comment_before(limit) && !program_.comments[comment_].own_line &&
        line_of(program_.comments[comment_].span.begin) == line_of(end)) {
      const Comment& comment = program_.comments[comment_++];
      out_ += "  " + comment_text(comment);
      last_end_ = comment.span.end;
    }
    out_ += '\n';
  }

  // ---- Text ----

  // A piece of the program as it stands, for what holds comments inside its brackets.
  void verbatim(std::uint32_t begin, std::uint32_t end) {
    std::string text = source_.text.substr(begin, end - begin);
    std::string clean;
    for (const char c : text) {
      if (c == '\n')
        while (!clean.empty() &&
               (clean.back() == ' ' || clean.back() == '\t' || clean.back() == '\r'))
          clean.pop_back();
      clean += c;
    }
    out_ += clean;
    while (comment_before(end)) ++comment_;
  }

  // An expression; `after` characters follow it on its line.
  void expression(const Expr& expr, std::size_t indent, std::size_t after = 0) {
    if (comment_before(expr.span.end)) return verbatim(expr.span.begin, expr.span.end);
    render(expressions_.document(expr), indent, format_width, after, out_);
  }

  // ---- Statements ----

  // The statements of a block; the next word of the program behind them begins at `limit`.
  void statements(const Block& block, std::size_t indent, std::uint32_t limit) {
    fresh_block_ = true;
    for (std::size_t i = 0; i < block.size(); ++i) {
      const Stmt& statement = *block[i];
      comments_before(statement.span.begin, indent);
      blank_line(statement.span.begin);
      indent_to(indent);
      const std::uint32_t next = i + 1 < block.size() ? block[i + 1]->span.begin : limit;
      print(statement, indent, next);
    }
  }

  // One statement and the end of its line.
  void print(const Stmt& statement, std::size_t indent, std::uint32_t limit) {
    if (is_simple(statement)) {
      if (comment_before(statement.span.end))
        verbatim(statement.span.begin, statement.span.end);
      else
        simple(statement, indent);
      return end_line(statement.span.end, limit);
    }
    if (const auto* node = std::get_if<IfStmt>(&statement.node))
      return print_if(*node, indent, limit);
    if (const auto* node = std::get_if<WhileStmt>(&statement.node)) {
      out_ += "while ";
      expression(*node->condition, indent, 2);
      return body(node->body, statement.span.begin, node->condition->span.end, indent, limit,
                  node->condition->parenthesised);
    }
    if (const auto* node = std::get_if<ForStmt>(&statement.node)) {
      out_ += "for " + node->variable + " in ";
      expression(*node->sequence, indent, 2);
      return body(node->body, statement.span.begin, node->sequence->span.end, indent, limit,
                  node->sequence->parenthesised);
    }
    if (const auto* node = std::get_if<FunctionStmt>(&statement.node)) {
      function_head(*node, indent);
      return body(node->body, statement.span.begin, node->head.end, indent, limit, true);
    }
    if (const auto* node = std::get_if<ActionStmt>(&statement.node)) {
      out_ += "action " + node->name;
      return body(node->body, statement.span.begin, node->name_span.end, indent, limit, true);
    }
  }

  // A statement that is no head of a block, without comments.
  void simple(const Stmt& statement, std::size_t indent) {
    if (const auto* assign = std::get_if<AssignStmt>(&statement.node)) {
      expression(*assign->target, indent, 5);
      out_ += assign_spellings[static_cast<std::size_t>(assign->op)];
      expression(*assign->value, indent);
      if (!assign->meta.empty()) {
        out_ += ' ';
        render(expressions_.metadata(assign->meta), indent, format_width, 0, out_);
      }
    } else if (const auto* evaluate = std::get_if<ExprStmt>(&statement.node)) {
      expression(*evaluate->value, indent);
    } else if (const auto* result = std::get_if<ReturnStmt>(&statement.node)) {
      out_ += "return";
      if (result->value) {
        out_ += ' ';
        expression(*result->value, indent);
      }
    } else if (const auto* movement = std::get_if<MovementStmt>(&statement.node)) {
      const bool pair = movement->kind != MovementKind::mix;
      if (movement->kind == MovementKind::add) out_ += "add ";
      out_ += pair ? "(" + movement->movement + ", " : movement->movement + " ";
      expression(*movement->value, indent, pair ? 1 : 0);
      if (pair) out_ += ')';
    } else if (const auto* import = std::get_if<ImportStmt>(&statement.node)) {
      out_ += "import " + import->module;
      if (!import->alias.empty()) out_ += " as " + import->alias;
    } else if (std::holds_alternative<BreakStmt>(statement.node)) {
      out_ += "break";
    } else {
      out_ += "continue";
    }
  }

  void function_head(const FunctionStmt& node, std::size_t indent) {
    if (comment_before(node.head.end)) return verbatim(node.head.begin, node.head.end);
    std::vector<Document> parameters;
    for (const Parameter& parameter : node.parameters) {
      std::vector<Document> row;
      row.push_back(Document::of(parameter.name));
      if (parameter.default_value) {
        row.push_back(Document::of(" = "));
        row.push_back(expressions_.document(*parameter.default_value));
      }
      parameters.push_back(Document::row(std::move(row)));
    }
    out_ += "function " + node.name;
    render(Document::group("(", std::move(parameters), ", ", ")", true), indent, format_width, 2,
           out_);
  }

  void print_if(const IfStmt& node, std::size_t indent, std::uint32_t limit) {
    const std::uint32_t begin = node.branches.front().head.begin;
    for (std::size_t i = 0; i < node.branches.size(); ++i) {
      const IfBranch& branch = node.branches[i];
      const std::uint32_t next =
          i + 1 < node.branches.size() ? node.branches[i + 1].head.begin : limit;
      if (i > 0) {
        // `} else` stays on its line unless comments stand between.
        const bool joined = node.branches[i - 1].body.braces && !comment_before(branch.head.begin);
        if (joined) {
          out_ += ' ';
        } else {
          if (node.branches[i - 1].body.braces)
            end_line(node.branches[i - 1].body.span.end, branch.head.begin);
          comments_before(branch.head.begin, indent);
          indent_to(indent);
        }
      }
      out_ += i == 0 ? "if" : branch.condition ? "else if" : "else";
      if (branch.condition) {
        out_ += ' ';
        expression(*branch.condition, indent, 2);
      }
      const bool more = i + 1 < node.branches.size();
      const bool closed = !branch.condition || branch.condition->parenthesised;
      body(branch.body, begin, branch.head.end, indent, next, closed, more);
    }
  }

  // ---- Blocks ----

  // What a head governs. `begin` and `head_end` are the head's places in the program, `limit` that
  // of the next word behind the block. With `open` a `}` does not end its line.
  void body(const Block& block, std::uint32_t begin, std::uint32_t head_end, std::size_t indent,
            std::uint32_t limit, bool closed, bool open = false) {
    if (on_one_line(block, closed)) {
      if (!(open && block.braces)) end_line(block.span.end, limit);
      last_end_ = std::max(last_end_, block.span.end);
      return;
    }
    if (block.braces) {
      // A comment behind the head or the `{`.
      out_ += " {";
      const std::uint32_t first = block.empty() ? block.span.end - 1 : block[0]->span.begin;
      last_end_ = block.span.begin;
      if (comment_before(block.span.begin))
        end_line(head_end, first);
      else
        end_line(block.span.begin, first);
      statements(block, indent + indent_step, block.span.end - 1);
      comments_before(block.span.end - 1, indent + indent_step);
      indent_to(indent);
      out_ += '}';
      last_end_ = block.span.end;
      if (!open) end_line(block.span.end, limit);
    } else {
      end_line(head_end, block.span.begin);
      statements(block, indent + indent_step, limit);
      comments_inside(limit, line_column(begin), indent + indent_step);
    }
    fresh_block_ = false;
  }

  // Prints a block that was written on its head's line, if it still fits there. `closed`: the head
  // ends in `)` or in a word.
  bool on_one_line(const Block& block, bool closed) {
    if (!block.same_line || comment_before(block.span.end) || block.size() > 100) return false;
    for (const StmtPtr& statement : block)
      if (!is_simple(*statement)) return false;
    const std::size_t size = out_.size();
    out_ += block.braces ? " {" : "";
    for (std::size_t i = 0; i < block.size(); ++i) {
      out_ += ' ';
      simple(*block[i], 0);
      if (i + 1 == block.size()) break;
      const bool movements = std::holds_alternative<MovementStmt>(block[i]->node) &&
                             std::holds_alternative<MovementStmt>(block[i + 1]->node);
      out_ += movements ? "," : ";";
    }
    out_ += block.braces ? " }" : "";

    // `if (a) b = 1` and `if a return b` need no colon; `if a: b = 1` reads better with one, and
    // `if (a): -b` would be a difference without.
    const std::string_view text = std::string_view(out_).substr(size);
    const char first = text.size() > 1 ? text[1] : '(';
    const bool letter =
        (first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z') || first == '_';
    const bool plain = block.size() == 1 && begins_with_keyword(*block[0]);
    if (!block.braces && !plain && (!closed || !letter || text.starts_with(" then")))
      out_.insert(size, ":");
    const bool broken = out_.find('\n', size) != std::string::npos;
    if (last_line_width(out_) <= format_width && !broken) return true;
    out_.resize(size);
    return false;
  }
};

}  // namespace

std::string format(const Program& program, const SourceMap& sources) {
  return Formatter(program, sources.file(program.file)).run();
}

}  // namespace pse::lang
