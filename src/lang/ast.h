// The tree of a program: what the parser makes and the lowering, the formatter and `--emit ast`
// read. Second stage of the flow: text -> tokens -> tree. Types are not known here; see lower/.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "diag/source.h"

namespace pse::lang {

struct Expr;
struct Stmt;
using ExprPtr = std::unique_ptr<Expr>;
using StmtPtr = std::unique_ptr<Stmt>;

// A run of statements and how it was written: in `{ }`, indented below its head, or (`same_line`)
// after it.
struct Block {
  std::vector<StmtPtr> statements;
  bool braces = false;
  bool same_line = false;  // the whole block stands on its head's line
  Span span;               // from the first statement, or `{`, to the end of the last, or `}`

  auto begin() const { return statements.begin(); }
  auto end() const { return statements.end(); }
  std::size_t size() const { return statements.size(); }
  bool empty() const { return statements.empty(); }
  const StmtPtr& operator[](std::size_t i) const { return statements[i]; }
};

// ---- Expressions --------------------------------------------------------------------------------

enum class UnaryOp : std::uint8_t { negate, logical_not };

// `power` is `^` or `**`; `logical_and`/`logical_or` are `and`/`or` or `&&`/`||`. The right side of
// the logical operators is evaluated only where the left side does not decide.
enum class BinaryOp : std::uint8_t {
  add, subtract, multiply, divide, modulo, power,
  less, less_equal, greater, greater_equal, equal, not_equal,
  logical_and, logical_or
};

struct NumberExpr {
  double value = 0;
  std::string spelling;  // as written, for the formatter
};

struct StringExpr {
  std::string value;  // escapes resolved
};

struct BoolExpr {
  bool value = false;
};

struct NameExpr {
  std::string name;
};

// `[a b c]` or `[a, b, c]`.
struct VectorExpr {
  std::vector<ExprPtr> elements;
};

// `[first .. last]`, or `[first .. last by step]`, both ends included; only what `for` runs over.
// `step` is null for 1.
struct RangeExpr {
  ExprPtr first, last, step;
};

// `(a, b)`: at least two elements in parentheses. The same value as a vector.
struct TupleExpr {
  std::vector<ExprPtr> elements;
};

struct UnaryExpr {
  UnaryOp op;
  ExprPtr operand;
};

struct BinaryExpr {
  BinaryOp op;
  ExprPtr left, right;
  Span op_span;
};

// `condition ? if_true : if_false`; only the taken side is evaluated.
struct ConditionalExpr {
  ExprPtr condition, if_true, if_false;
};

struct Argument {
  std::string name;  // empty for a positional argument
  Span name_span;
  ExprPtr value;
};

struct CallExpr {
  ExprPtr callee;  // a NameExpr, or a MemberExpr for `module.function`
  std::vector<Argument> arguments;
};

// `base[i]` or `base[i, j]`; indices count from 1.
struct IndexExpr {
  ExprPtr base;
  std::vector<ExprPtr> indices;
};

// `base.name`: a swizzle (`p.x`, `c.rgb`), a channel of a named image (`fg.color`), a function of a
// module, an action's clock (`blink.Time`).
struct MemberExpr {
  ExprPtr base;
  std::string name;
  Span name_span;
};

struct Expr {
  Span span;
  std::variant<NumberExpr, StringExpr, BoolExpr, NameExpr, VectorExpr, RangeExpr, TupleExpr,
               UnaryExpr, BinaryExpr, ConditionalExpr, CallExpr, IndexExpr, MemberExpr>
      node;
  bool parenthesised = false;  // written in parentheses; the formatter keeps them
  std::uint16_t height = 1;    // levels of this tree, leaves being 1; at most max_height
};

// ---- Statements ---------------------------------------------------------------------------------

enum class AssignOp : std::uint8_t { set, add, subtract, multiply, divide, power };

// One `name = expression` of a knob's metadata.
struct MetaEntry {
  std::string name;  // min max label help widget options units ...
  Span span;
  ExprPtr value;
};

struct AssignStmt {
  ExprPtr target;  // NameExpr, IndexExpr or MemberExpr
  AssignOp op = AssignOp::set;
  ExprPtr value;
  std::vector<MetaEntry> meta;  // `Radius = 0.4 [[ min = 0, max = 1, help = "..." ]]`
};

struct ExprStmt {
  ExprPtr value;
};

// `if / else if / else`; each branch has a condition, the final else has a null one.
struct IfBranch {
  ExprPtr condition;
  Block body;
  Span head;  // from the keyword to the end of the condition
};
struct IfStmt {
  std::vector<IfBranch> branches;
};

struct WhileStmt {
  ExprPtr condition;
  Block body;
};

// `for variable in sequence`: a RangeExpr, an array or a vector.
struct ForStmt {
  std::string variable;
  Span variable_span;
  ExprPtr sequence;
  Block body;
};

struct ReturnStmt {
  ExprPtr value;  // may be null
};
struct BreakStmt {};
struct ContinueStmt {};

struct Parameter {
  std::string name;
  Span span;
  ExprPtr default_value;  // may be null
};

struct FunctionStmt {
  std::string name;
  Span name_span;
  std::vector<Parameter> parameters;
  Block body;
  Span head;  // from `function` to the `)`
};

// `import name` or `import name as alias`: the module `name.pse`, beside this file or on PSE_PATH.
struct ImportStmt {
  std::string module;
  Span module_span;
  std::string alias;  // empty: its functions and constants are visible unprefixed
};

// `action name { ... }`. Parsed and printed; its run-time belongs to motion/.
struct ActionStmt {
  std::string name;
  Span name_span;
  Block body;
};

// Inside an action: `(MOVE, value)` sets, `add (MOVE, value)` adds, `name amount` mixes an action
// in.
enum class MovementKind : std::uint8_t { set, add, mix };
struct MovementStmt {
  MovementKind kind = MovementKind::set;
  std::string movement;
  Span movement_span;
  ExprPtr value;
};

struct Stmt {
  Span span;
  std::variant<AssignStmt, ExprStmt, IfStmt, WhileStmt, ForStmt, ReturnStmt, BreakStmt,
               ContinueStmt, FunctionStmt, ImportStmt, ActionStmt, MovementStmt>
      node;
};

// A comment as written, without its marker. The formatter puts comments back by their place.
struct Comment {
  Span span;
  std::string text;
  bool own_line = false;  // nothing but white space before it on its line
};

struct Program {
  FileId file = no_file;
  Block body;
  std::vector<Comment> comments;
};

}  // namespace pse::lang
