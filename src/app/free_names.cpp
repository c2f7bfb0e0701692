// A walk over the tree that collects members of unknown names.
#include "app/free_names.h"

#include <map>
#include <set>
#include <type_traits>

#include "stream/image_plane.h"

namespace pse::app {
namespace {

using namespace lang;

class Walk {
 public:
  std::set<std::string> bound;  // names that are set, or are functions or parameters
  std::map<std::string, std::set<std::string>> members;  // name -> members read of it

  void block(const Block& statements) {
    for (const StmtPtr& statement : statements)
      if (statement) std::visit([this](const auto& node) { visit(node); }, statement->node);
  }

 private:
  void expression(const ExprPtr& expr) {
    if (expr) std::visit([this](const auto& node) { visit(node); }, expr->node);
  }
  void expressions(const std::vector<ExprPtr>& list) {
    for (const ExprPtr& expr : list) expression(expr);
  }

  // Expressions.
  void visit(const NumberExpr&) {}
  void visit(const StringExpr&) {}
  void visit(const BoolExpr&) {}
  void visit(const NameExpr&) {}
  void visit(const VectorExpr& e) { expressions(e.elements); }
  void visit(const TupleExpr& e) { expressions(e.elements); }
  void visit(const RangeExpr& e) { expression(e.first), expression(e.last), expression(e.step); }
  void visit(const UnaryExpr& e) { expression(e.operand); }
  void visit(const BinaryExpr& e) { expression(e.left), expression(e.right); }
  void visit(const ConditionalExpr& e) {
    expression(e.condition), expression(e.if_true), expression(e.if_false);
  }
  void visit(const IndexExpr& e) { expression(e.base), expressions(e.indices); }
  void visit(const CallExpr& e) {
    expression(e.callee);
    for (const Argument& argument : e.arguments) expression(argument.value);
  }
  void visit(const MemberExpr& e) {
    const auto* name = e.base ? std::get_if<NameExpr>(&e.base->node) : nullptr;
    if (name != nullptr)
      members[name->name].insert(e.name);
    else
      expression(e.base);
  }

  // Statements.
  void visit(const AssignStmt& s) {
    target(s.target);
    expression(s.value);
  }
  void visit(const ExprStmt& s) { expression(s.value); }
  void visit(const IfStmt& s) {
    for (const IfBranch& branch : s.branches) expression(branch.condition), block(branch.body);
  }
  void visit(const WhileStmt& s) { expression(s.condition), block(s.body); }
  void visit(const ForStmt& s) {
    bound.insert(s.variable);
    expression(s.sequence), block(s.body);
  }
  void visit(const ReturnStmt& s) { expression(s.value); }
  void visit(const BreakStmt&) {}
  void visit(const ContinueStmt&) {}
  void visit(const FunctionStmt& s) {
    bound.insert(s.name);
    for (const Parameter& parameter : s.parameters) bound.insert(parameter.name);
    block(s.body);
  }
  void visit(const ImportStmt& s) { bound.insert(s.alias.empty() ? s.module : s.alias); }
  void visit(const ActionStmt& s) { bound.insert(s.name); }
  void visit(const MovementStmt&) {}

  // The name that an assignment sets: `a`, `a[i]`, `a.x`.
  void target(const ExprPtr& expr) {
    if (!expr) return;
    if (const auto* name = std::get_if<NameExpr>(&expr->node)) bound.insert(name->name);
    if (const auto* index = std::get_if<IndexExpr>(&expr->node))
      target(index->base), expressions(index->indices);
    if (const auto* member = std::get_if<MemberExpr>(&expr->node)) target(member->base);
  }
};

int likely_components(const std::string& channel) {
  return channel == "alpha" || (!channel.empty() && channel[0] >= 'A' && channel[0] <= 'Z') ? 1 : 3;
}

}  // namespace

std::vector<StreamName> image_names_read(const lang::Program& program) {
  Walk walk;
  walk.block(program.body);
  for (const StreamName& name : image_plane_names()) walk.bound.insert(name.name);
  std::vector<StreamName> names = {{"color", 3}, {"alpha", 1}, {"Z", 1}};
  for (const StreamName& name : names) walk.bound.insert(name.name);
  for (const auto& [name, members] : walk.members) {
    if (walk.bound.contains(name)) continue;
    for (const std::string& member : members)
      names.push_back({name + "." + member, likely_components(member)});
  }
  return names;
}

}  // namespace pse::app
