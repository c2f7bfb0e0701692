// The formatter's inside: expressions become documents, statements become lines, comments go back
// to their places.
#pragma once

#include <string>
#include <vector>

#include "lang/ast.h"
#include "lang/format_document.h"

namespace pse::lang {

inline constexpr std::size_t format_width = 100;

// Expressions (format_expressions.cpp).
class ExpressionFormatter {
 public:
  explicit ExpressionFormatter(const SourceFile& source) : source_(source) {}

  Document document(const Expr& expr) const;
  // [[ name = value, ... ]]
  Document metadata(const std::vector<MetaEntry>& entries) const;

 private:
  Document document(const NumberExpr& node, const Expr& expr) const;
  Document document(const StringExpr& node, const Expr& expr) const;
  Document document(const BoolExpr& node, const Expr& expr) const;
  Document document(const NameExpr& node, const Expr& expr) const;
  Document document(const VectorExpr& node, const Expr& expr) const;
  Document document(const RangeExpr& node, const Expr& expr) const;
  Document document(const TupleExpr& node, const Expr& expr) const;
  Document document(const UnaryExpr& node, const Expr& expr) const;
  Document document(const BinaryExpr& node, const Expr& expr) const;
  Document document(const ConditionalExpr& node, const Expr& expr) const;
  Document document(const CallExpr& node, const Expr& expr) const;
  Document document(const IndexExpr& node, const Expr& expr) const;
  Document document(const MemberExpr& node, const Expr& expr) const;
  std::vector<Document> documents(const std::vector<ExprPtr>& list) const;

  const SourceFile& source_;
};

}  // namespace pse::lang
