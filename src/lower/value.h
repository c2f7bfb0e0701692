// What an expression is while it is lowered: its shape, and the IR values of its components.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ir/module.h"
#include "lang/ast.h"

namespace pse::lower {

struct ModuleScope;

// `error` stands for something already reported: whatever is made of it is silent.
enum class Kind { error, nothing, number, boolean, vector, matrix, text, array, function };

// A function that can be called or passed: one of a module's, or a builtin by name.
struct FunctionRef {
  const lang::FunctionStmt* definition = nullptr;
  ModuleScope* scope = nullptr;  // where its free names are looked up
  std::string builtin;
};

struct Typed {
  Kind kind = Kind::error;
  int rows = 1;     // components of a vector; rows of a matrix
  int columns = 1;  // columns of a matrix
  std::vector<ir::Value> parts;  // components; a matrix row by row
  std::string text;
  FunctionRef function;
  std::int32_t array = -1;  // index into ir::Function::arrays

  bool is_error() const { return kind == Kind::error; }
  bool is_numeric() const {
    return kind == Kind::number || kind == Kind::boolean || kind == Kind::vector ||
           kind == Kind::matrix;
  }
  int components() const { return static_cast<int>(parts.size()); }
};

bool same_shape(const Typed& a, const Typed& b);
// "a number", "a vector of 3", "a 2x2 matrix", ... for messages.
std::string describe(const Typed& value);

// The variables of one function call (or of the top level), by name. Names that start with `%` are
// the lowering's own.
using Variables = std::map<std::string, Typed>;

// The names that one file defines.
struct ModuleScope {
  FileId file = no_file;
  std::string name;
  std::unique_ptr<lang::Program> program;  // null for the main program, which its caller owns
  std::map<std::string, const lang::FunctionStmt*> functions;
  // Top-level `name = expression` of imported files.
  std::map<std::string, const lang::Expr*> constants;
  std::map<std::string, std::size_t> knobs;            // the constants that are knobs: their places
  std::vector<ModuleScope*> open_imports;              // `import m`
  std::map<std::string, ModuleScope*> named_imports;   // `import m as k`
};

}  // namespace pse::lower
