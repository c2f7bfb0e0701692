// Questions about a piece of tree that the lowering asks before it lowers it.
#pragma once

#include <set>
#include <string>

#include "lang/ast.h"

namespace pse::lower {

// Names that the block assigns (`x = `, `x[i] = `, `x.y = `), nested blocks included, functions
// excluded.
void collect_assigned(const lang::Block& block, std::set<std::string>& names);

// Names that are only ever assigned by index: they become arrays where nothing else binds them.
std::set<std::string> array_candidates(const lang::Block& block);

// How many times the block mentions `name` in an expression or as a target.
int count_mentions(const lang::Block& block, const std::string& name);

// Which ways of leaving early occur in a statement; `break` and `continue` only as far as they
// leave the statement.
struct Exits {
  bool returns = false, breaks = false, continues = false;
  bool any() const { return returns || breaks || continues; }
};
Exits exits_of(const lang::Stmt& statement);
Exits exits_of(const lang::Block& block);

// Whether control never runs past the end of the block.
bool always_exits(const lang::Block& block);

}  // namespace pse::lower
