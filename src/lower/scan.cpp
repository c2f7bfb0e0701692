// Walks over the tree that answer scan.h's questions.
#include "lower/scan.h"

#include <functional>

namespace pse::lower {
namespace {

using namespace lang;

template <class... F>
struct Overload : F... {
  using F::operator()...;
};

// The name at the root of an assignment's target; empty when there is none.
std::string root_name(const Expr& target) {
  if (const auto* name = std::get_if<NameExpr>(&target.node)) return name->name;
  if (const auto* index = std::get_if<IndexExpr>(&target.node)) return root_name(*index->base);
  if (const auto* member = std::get_if<MemberExpr>(&target.node)) return root_name(*member->base);
  return {};
}

// Calls `visit` on every statement of the block, nested ones included, functions and actions
// excluded.
void walk(const Block& block, const std::function<void(const Stmt&)>& visit) {
  for (const StmtPtr& statement : block) {
    if (!statement) continue;
    visit(*statement);
    std::visit(Overload{[&](const IfStmt& s) {
                          for (const IfBranch& branch : s.branches) walk(branch.body, visit);
                        },
                        [&](const WhileStmt& s) { walk(s.body, visit); },
                        [&](const ForStmt& s) { walk(s.body, visit); }, [](const auto&) {}},
               statement->node);
  }
}

int mentions(const ExprPtr& expr, const std::string& name) {
  if (!expr) return 0;
  const auto all = [&](const std::vector<ExprPtr>& list) {
    int sum = 0;
    for (const ExprPtr& e : list) sum += mentions(e, name);
    return sum;
  };
  return std::visit(
      Overload{
          [&](const NameExpr& e) { return e.name == name ? 1 : 0; },
          [&](const VectorExpr& e) { return all(e.elements); },
          [&](const TupleExpr& e) { return all(e.elements); },
          [&](const RangeExpr& e) {
            return mentions(e.first, name) + mentions(e.last, name) + mentions(e.step, name);
          },
          [&](const UnaryExpr& e) { return mentions(e.operand, name); },
          [&](const BinaryExpr& e) { return mentions(e.left, name) + mentions(e.right, name); },
          [&](const ConditionalExpr& e) {
            return mentions(e.condition, name) + mentions(e.if_true, name) +
                   mentions(e.if_false, name);
          },
          [&](const CallExpr& e) {
            int sum = mentions(e.callee, name);
            for (const Argument& argument : e.arguments) sum += mentions(argument.value, name);
            return sum;
          },
          [&](const IndexExpr& e) { return mentions(e.base, name) + all(e.indices); },
          [&](const MemberExpr& e) { return mentions(e.base, name); },
          [](const auto&) { return 0; }},
      expr->node);
}

}  // namespace

void collect_assigned(const Block& block, std::set<std::string>& names) {
  walk(block, [&](const Stmt& statement) {
    if (const auto* assign = std::get_if<AssignStmt>(&statement.node)) {
      if (const std::string name = root_name(*assign->target); !name.empty()) names.insert(name);
    } else if (const auto* loop = std::get_if<ForStmt>(&statement.node)) {
      names.insert(loop->variable);
    }
  });
}

std::set<std::string> array_candidates(const Block& block) {
  std::set<std::string> indexed, plain;
  walk(block, [&](const Stmt& statement) {
    if (const auto* assign = std::get_if<AssignStmt>(&statement.node)) {
      const std::string name = root_name(*assign->target);
      if (std::holds_alternative<IndexExpr>(assign->target->node))
        indexed.insert(name);
      else
        plain.insert(name);
    } else if (const auto* loop = std::get_if<ForStmt>(&statement.node)) {
      plain.insert(loop->variable);
    }
  });
  for (const std::string& name : plain) indexed.erase(name);
  indexed.erase("");
  return indexed;
}

int count_mentions(const Block& block, const std::string& name) {
  int sum = 0;
  walk(block, [&](const Stmt& statement) {
    std::visit(
        Overload{
            [&](const AssignStmt& s) { sum += mentions(s.target, name) + mentions(s.value, name); },
            [&](const ExprStmt& s) { sum += mentions(s.value, name); },
            [&](const IfStmt& s) {
              for (const IfBranch& branch : s.branches) sum += mentions(branch.condition, name);
            },
            [&](const WhileStmt& s) { sum += mentions(s.condition, name); },
            [&](const ForStmt& s) { sum += mentions(s.sequence, name); },
            [&](const ReturnStmt& s) { sum += mentions(s.value, name); }, [](const auto&) {}},
        statement.node);
  });
  return sum;
}

Exits exits_of(const Stmt& statement) {
  return std::visit(
      Overload{[](const ReturnStmt&) { return Exits{.returns = true}; },
               [](const BreakStmt&) { return Exits{.breaks = true}; },
               [](const ContinueStmt&) { return Exits{.continues = true}; },
               [](const IfStmt& s) {
                 Exits exits;
                 for (const IfBranch& branch : s.branches) {
                   const Exits inner = exits_of(branch.body);
                   exits.returns |= inner.returns;
                   exits.breaks |= inner.breaks;
                   exits.continues |= inner.continues;
                 }
                 return exits;
               },
               [](const WhileStmt& s) { return Exits{.returns = exits_of(s.body).returns}; },
               [](const ForStmt& s) { return Exits{.returns = exits_of(s.body).returns}; },
               [](const auto&) { return Exits{}; }},
      statement.node);
}

Exits exits_of(const Block& block) {
  Exits exits;
  for (const StmtPtr& statement : block) {
    if (!statement) continue;
    const Exits inner = exits_of(*statement);
    exits.returns |= inner.returns;
    exits.breaks |= inner.breaks;
    exits.continues |= inner.continues;
  }
  return exits;
}

bool always_exits(const Block& block) {
  for (const StmtPtr& statement : block) {
    if (!statement) continue;
    const bool leaves = std::visit(
        Overload{[](const ReturnStmt&) { return true; }, [](const BreakStmt&) { return true; },
                 [](const ContinueStmt&) { return true; },
                 [](const IfStmt& s) {
                   if (s.branches.empty() || s.branches.back().condition) return false;
                   for (const IfBranch& branch : s.branches)
                     if (!always_exits(branch.body)) return false;
                   return true;
                 },
                 [](const auto&) { return false; }},
        statement->node);
    if (leaves) return true;
  }
  return false;
}

}  // namespace pse::lower
