// Expressions in pse's one layout: a space on both sides of an operator, commas where the program
// has them.
#include <array>

#include "lang/format_state.h"

namespace pse::lang {

namespace {

constexpr std::array binary_spellings = {" + ",  " - ", " * ",  " / ",  " % ",  " ^ ",   " < ",
                                         " <= ", " > ", " >= ", " == ", " != ", " and ", " or "};

// A text in straight double quotes.
std::string quoted(const std::string& value) {
  std::string out = "\"";
  for (const char c : value) {
    switch (c) {
      case '\n':
        out += "\\n";
        break;
      case '\t':
        out += "\\t";
        break;
      case '\r':
        out += "\\r";
        break;
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      default:
        out += c;
    }
  }
  return out + "\"";
}

// A row built without copying its parts.
class Row {
 public:
  Row& add(std::string text) { return add(Document::of(std::move(text))); }
  Row& add(Document part) {
    parts_.push_back(std::move(part));
    return *this;
  }
  Document done() { return Document::row(std::move(parts_)); }

 private:
  std::vector<Document> parts_;
};

Document bracketed(std::string open, Document inside, std::string close) {
  std::vector<Document> parts;
  parts.push_back(std::move(inside));
  return Document::group(std::move(open), std::move(parts), "", std::move(close), false);
}

}  // namespace

Document ExpressionFormatter::document(const Expr& expr) const {
  Document inside = std::visit([&](const auto& node) { return document(node, expr); }, expr.node);
  return expr.parenthesised ? bracketed("(", std::move(inside), ")") : inside;
}

Document ExpressionFormatter::metadata(const std::vector<MetaEntry>& entries) const {
  std::vector<Document> parts;
  for (const MetaEntry& entry : entries)
    parts.push_back(Row().add(entry.name + " = ").add(document(*entry.value)).done());
  return Document::group("[[ ", std::move(parts), ", ", " ]]", true);
}

std::vector<Document> ExpressionFormatter::documents(const std::vector<ExprPtr>& list) const {
  std::vector<Document> parts;
  for (const ExprPtr& expr : list) parts.push_back(document(*expr));
  return parts;
}

Document ExpressionFormatter::document(const NumberExpr& node, const Expr&) const {
  return Document::of(node.spelling);
}
Document ExpressionFormatter::document(const StringExpr& node, const Expr&) const {
  return Document::of(quoted(node.value));
}
Document ExpressionFormatter::document(const BoolExpr& node, const Expr&) const {
  return Document::of(node.value ? "true" : "false");
}
Document ExpressionFormatter::document(const NameExpr& node, const Expr&) const {
  return Document::of(node.name);
}

Document ExpressionFormatter::document(const VectorExpr& node, const Expr&) const {
  // Elements are set apart as in the program: by commas, or by white space alone.
  bool commas = false;
  for (std::size_t i = 0; i + 1 < node.elements.size(); ++i) {
    const Span &left = node.elements[i]->span, &right = node.elements[i + 1]->span;
    commas |= source_.text.substr(left.end, right.begin - left.end).find(',') != std::string::npos;
  }
  return Document::group("[", documents(node.elements), commas ? ", " : " ", "]", true);
}

Document ExpressionFormatter::document(const RangeExpr& node, const Expr&) const {
  Row row;
  row.add(document(*node.first)).add(" .. ").add(document(*node.last));
  if (node.step) row.add(" by ").add(document(*node.step));
  return bracketed("[", row.done(), "]");
}

Document ExpressionFormatter::document(const TupleExpr& node, const Expr&) const {
  return Document::group("(", documents(node.elements), ", ", ")", true);
}

Document ExpressionFormatter::document(const UnaryExpr& node, const Expr&) const {
  return Row().add(node.op == UnaryOp::negate ? "-" : "not ").add(document(*node.operand)).done();
}

Document ExpressionFormatter::document(const BinaryExpr& node, const Expr&) const {
  const char* spelling = binary_spellings[static_cast<std::size_t>(node.op)];
  return Row().add(document(*node.left)).add(spelling).add(document(*node.right)).done();
}

Document ExpressionFormatter::document(const ConditionalExpr& node, const Expr&) const {
  Row row;
  row.add(document(*node.condition)).add(" ? ").add(document(*node.if_true));
  return row.add(" : ").add(document(*node.if_false)).done();
}

Document ExpressionFormatter::document(const CallExpr& node, const Expr&) const {
  std::vector<Document> arguments;
  for (const Argument& argument : node.arguments) {
    Row row;
    if (!argument.name.empty()) row.add(argument.name + " = ");
    arguments.push_back(row.add(document(*argument.value)).done());
  }
  return Row()
      .add(document(*node.callee))
      .add(Document::group("(", std::move(arguments), ", ", ")", true))
      .done();
}

Document ExpressionFormatter::document(const IndexExpr& node, const Expr&) const {
  return Row()
      .add(document(*node.base))
      .add(Document::group("[", documents(node.indices), ", ", "]", true))
      .done();
}

Document ExpressionFormatter::document(const MemberExpr& node, const Expr&) const {
  return Row().add(document(*node.base)).add("." + node.name).done();
}

}  // namespace pse::lang
