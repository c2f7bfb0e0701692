// text -> tokens -> tree, in one call.
#pragma once

#include "diag/diagnostics.h"
#include "lang/ast.h"

namespace pse::lang {

// What a text may ask of the front end before it is refused with an error.
struct ParseLimits {
  std::size_t max_bytes = 4u << 20;
  int max_nesting = 200;  // of brackets, blocks, prefix and right-associative operators together
  // Of one expression's tree: a long chain a + b + c + ... is as high as it is long.
  int max_height = 1000;
  std::size_t max_nodes = 1'000'000;
};

// Parses one source file. All errors go to `diagnostics`; the tree holds what could be understood
// and is only meant to be used further when there were none. Never throws for any text; time and
// memory are linear in its size.
Program parse(const SourceMap& sources, FileId file, Diagnostics& diagnostics,
              const ParseLimits& limits = {});

// One expression, as on the command line (`Name=value`). Null after an error.
ExprPtr parse_expression(const SourceMap& sources, FileId file, Diagnostics& diagnostics);

// The printable forms behind `--emit tokens` and `--emit ast`.
std::string print_tokens(const SourceMap& sources, FileId file);
std::string print_ast(const Program& program);

// `pse fmt`: the program in pse's one layout. Idempotent; keeps comments, blank lines between
// statements (at most one) and each block's choice of indentation or braces. Call only on a program
// that parsed without errors.
std::string format(const Program& program, const SourceMap& sources);

}  // namespace pse::lang
