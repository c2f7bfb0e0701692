// Programs that are functions: `function density(p)` alone says what is where, and a command that
// needs outputs calls it at the samples' points. The lines added are the user's own language and
// are kept with the program's text.
#pragma once

#include <string>
#include <vector>

#include "app/program_file.h"
#include "lang/ast.h"

namespace pse::app {

// How many arguments a function of the program must be given at least; -1 where it has none of that
// name.
int required_parameters(const lang::Program& tree, const std::string& name);
// From `function` to the `)` of the function `name`.
std::optional<Span> function_head(const lang::Program& tree, const std::string& name);
// Why the function `density` cannot be called with a place alone: a sentence; empty where it can,
// or where there is none.
std::string density_wants_more(const lang::Program& tree);
// Whether the program sets `name` outside its functions.
bool sets_at_top(const lang::Program& tree, const std::string& name);

// The line that makes a picture of a program which says how dense space is and sets nothing that
// could be written: hypertexture() with the chapter's functions that the program has. Empty where
// there is no `density`, or something is set.
std::string hypertexture_line(const lang::Program& tree);

// The first call of the function `name` in what the program sets outside its functions.
std::optional<Span> find_call(const lang::Program& tree, const std::string& name);

// Lines that set each of `names` by calling the function of that name at `point`; functions of two
// parameters, as `color(p, density)`, are given the density too.
std::string calls_at_point(const lang::Program& tree, const std::vector<std::string>& names);

// The program with lines behind its own, as another file of the same name.
void append_lines(ProgramFile& program, const std::string& lines);

}  // namespace pse::app
