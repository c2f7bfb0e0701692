// `--emit ast`: the tree as indented text, without places, so that two texts with the same meaning
// print the same.
#include <array>
#include <charconv>

#include "diag/utf8.h"
#include "lang/parser.h"

namespace pse::lang {

namespace {

constexpr std::array binary_names = {"add",   "subtract",  "multiply",   "divide",  "modulo",
                                     "power", "less",      "less_equal", "greater", "greater_equal",
                                     "equal", "not_equal", "and",        "or"};
constexpr std::array assign_names = {"set",          "set_add",    "set_subtract",
                                     "set_multiply", "set_divide", "set_power"};
constexpr std::array movement_names = {"movement", "add_movement", "mix_action"};

std::string number_text(double value) {
  std::array<char, 64> text;
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), result.ptr};
}

// A text in quotes, on one line, whatever it holds.
std::string quoted(std::string_view value) {
  std::string out = "\"";
  for (const char c : utf8_repaired(value)) {
    if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (c == '\r')
      out += "\\r";
    else if (c == '"' || c == '\\')
      (out += '\\') += c;
    else
      out += c;
  }
  return out + "\"";
}

// Expressions print on one line, as (operator operand ...).
class Printer {
 public:
  std::string out;

  void block(const Block& block, int depth) {
    for (const StmtPtr& statement : block) print(*statement, depth);
  }

 private:
  void line(int depth, std::string_view head) {
    out.append(2 * static_cast<std::size_t>(depth), ' ');
    out += head;
  }

  // ---- Statements ----
  void print(const Stmt& statement, int depth) {
    std::visit([&](const auto& node) { print_node(node, depth); }, statement.node);
  }

  void print_node(const AssignStmt& node, int depth) {
    line(depth, assign_names[static_cast<std::size_t>(node.op)]);
    operand(node.target);
    operand(node.value);
    for (const MetaEntry& entry : node.meta) {
      out += " [" + entry.name;
      operand(entry.value);
      out += "]";
    }
    out += "\n";
  }
  void print_node(const ExprStmt& node, int depth) {
    line(depth, "evaluate");
    operand(node.value);
    out += "\n";
  }
  void print_node(const IfStmt& node, int depth) {
    const char* head = "if";
    for (const IfBranch& branch : node.branches) {
      line(depth, branch.condition ? head : "else");
      if (branch.condition) operand(branch.condition);
      out += "\n";
      block(branch.body, depth + 1);
      head = "else_if";
    }
  }
  void print_node(const WhileStmt& node, int depth) {
    line(depth, "while");
    operand(node.condition);
    out += "\n";
    block(node.body, depth + 1);
  }
  void print_node(const ForStmt& node, int depth) {
    line(depth, "for " + node.variable);
    operand(node.sequence);
    out += "\n";
    block(node.body, depth + 1);
  }
  void print_node(const ReturnStmt& node, int depth) {
    line(depth, "return");
    if (node.value) operand(node.value);
    out += "\n";
  }
  void print_node(const BreakStmt&, int depth) { line(depth, "break\n"); }
  void print_node(const ContinueStmt&, int depth) { line(depth, "continue\n"); }
  void print_node(const FunctionStmt& node, int depth) {
    line(depth, "function " + node.name);
    for (const Parameter& parameter : node.parameters) {
      out += " " + parameter.name;
      if (!parameter.default_value) continue;
      out += "=";
      print(*parameter.default_value);
    }
    out += "\n";
    block(node.body, depth + 1);
  }
  void print_node(const ImportStmt& node, int depth) {
    line(depth, "import " + node.module + (node.alias.empty() ? "" : " as " + node.alias) + "\n");
  }
  void print_node(const ActionStmt& node, int depth) {
    line(depth, "action " + node.name + "\n");
    block(node.body, depth + 1);
  }
  void print_node(const MovementStmt& node, int depth) {
    line(depth,
         std::string(movement_names[static_cast<std::size_t>(node.kind)]) + " " + node.movement);
    operand(node.value);
    out += "\n";
  }

  // ---- Expressions ----
  void operand(const ExprPtr& expr) {
    out += ' ';
    if (expr)
      print(*expr);
    else
      out += "?";  // not understood
  }
  void operands(const std::vector<ExprPtr>& list) {
    for (const ExprPtr& expr : list) operand(expr);
  }
  void print(const Expr& expr) {
    std::visit([&](const auto& node) { print_node(node); }, expr.node);
  }
  void print_node(const NumberExpr& node) { out += number_text(node.value); }
  void print_node(const StringExpr& node) { out += quoted(node.value); }
  void print_node(const BoolExpr& node) { out += node.value ? "true" : "false"; }
  void print_node(const NameExpr& node) { out += node.name; }
  void print_node(const VectorExpr& node) {
    out += "(vector";
    operands(node.elements);
    out += ")";
  }
  void print_node(const TupleExpr& node) {
    out += "(tuple";
    operands(node.elements);
    out += ")";
  }
  void print_node(const RangeExpr& node) {
    out += "(range";
    operand(node.first);
    operand(node.last);
    if (node.step) operand(node.step);
    out += ")";
  }
  void print_node(const UnaryExpr& node) {
    out += node.op == UnaryOp::negate ? "(negate" : "(not";
    operand(node.operand);
    out += ")";
  }
  void print_node(const BinaryExpr& node) {
    out += "(";
    out += binary_names[static_cast<std::size_t>(node.op)];
    operand(node.left);
    operand(node.right);
    out += ")";
  }
  void print_node(const ConditionalExpr& node) {
    out += "(choose";
    operand(node.condition);
    operand(node.if_true);
    operand(node.if_false);
    out += ")";
  }
  void print_node(const CallExpr& node) {
    out += "(call";
    operand(node.callee);
    for (const Argument& argument : node.arguments) {
      out += ' ';
      if (!argument.name.empty()) out += argument.name + "=";
      print(*argument.value);
    }
    out += ")";
  }
  void print_node(const IndexExpr& node) {
    out += "(index";
    operand(node.base);
    operands(node.indices);
    out += ")";
  }
  void print_node(const MemberExpr& node) {
    out += "(member";
    operand(node.base);
    out += " " + node.name + ")";
  }
};

}  // namespace

std::string print_ast(const Program& program) {
  Printer printer;
  printer.block(program.body, 0);
  return printer.out;
}

}  // namespace pse::lang
