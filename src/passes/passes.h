// The passes, one per file. Each keeps a module's meaning bit for bit and takes time near linear in
// its size.
#pragma once

#include <cstdint>
#include <vector>

#include "ir/module.h"
#include "passes/pipeline.h"

namespace pse::passes {

// outline.cpp: in large programs, copies of a called function that are alike become one function.
// `calls` are those of the entry function. Returns the index of the first function made.
// pipeline.h has the options.
std::size_t outline(ir::Module& module, const std::vector<ir::CallRange>& calls,
                    const OutlineOptions& options = {});

// settle_expectations.cpp: expectations whose values are wanted become effects that tell the host
// of the pixel. Runs after a first remove_dead, on a module fresh from the lowering.
void settle_expectations(ir::Module& module);

// Whether the program asks for slopes once branches that constants decide are gone.
bool asks_when_folded(ir::Module module);
// Puts 0 in the place of each `slope`, and changes nothing else.
void forget_slopes(ir::Module& module);

// slopes.cpp: the derivative takes the place of each `slope` instruction, for inputs "NAME$x" and
// "NAME$y" are added. Before it the others do not know what such a value depends on.
void resolve_slopes(ir::Module& module);

// inline_calls.cpp: copies called functions into their callers.
struct InlineOptions {
  std::size_t small = 40;           // functions up to this many instructions, always
  std::size_t single = 1u << 20;    // functions with one call site, up to this many
  std::size_t max_total = 600'000;  // no more once the module has this many
  std::size_t first_kept = ~std::size_t{0};  // functions from this one on: only where small
};
void inline_calls(ir::Module& module, const InlineOptions& options = {});

// fold.cpp: constants, identities that are exact, conditions that are known, calls of constants.
void fold(ir::Module& module);

// share.cpp: what was computed already is not computed again.
void share(ir::Module& module);

// simplify_loops.cpp: loops that never turn, and what they carry without changing it.
void simplify_loops(ir::Module& module);

// unroll.cpp: short loops with a known number of turns become straight code.
struct UnrollOptions {
  std::size_t max_instructions = 160;  // of the straight code
};
void unroll(ir::Module& module, const UnrollOptions& options = {});

// decide.cpp: conditions that the ranges of values decide, such as the checks of clamped indices.
void decide(ir::Module& module);

// convert_ifs.cpp: small ifs without effects become selects.
struct ConvertOptions {
  int max_cost = 32;  // of both sides together, in additions
};
void convert_ifs(ir::Module& module, const ConvertOptions& options = {});

// hoist.cpp: what does not change within a loop is computed before it.
void hoist(ir::Module& module);

// remove_dead.cpp: instructions, loop parameters, arrays and functions that nothing observes.
struct DeadOptions {
  bool arrays = true;          // off: arrays keep their numbers
  bool functions = true;       // likewise functions
  std::vector<bool> observed;  // arrays whose elements are read when the function is over
};
void remove_dead(ir::Module& module, const DeadOptions& options = {});

// rates.cpp: gives every value and array of a function its rate. Arrays marked in `of_sample` are
// of rate sample, and all that are written under control or with values of rate sample become so
// and are marked.
void assign_rates(const ir::Module& module, ir::Function& function, std::vector<bool>& of_sample);
void assign_rates(ir::Module& module);

// hoist_frame.cpp: cheap work of rate frame leaves the ifs and loops of rate sample around it.
// Needs rates.
void hoist_frame(ir::Module& module);

// compact_values.cpp: values numbered in the order of their definition, without gaps.
void compact_values(ir::Module& module);

// split.cpp: cuts the program into what is done per frame and per sample.
SplitModule split(ir::Module module);
// After a split: what the two functions do not need. Slots and arrays keep their numbers.
void remove_dead(SplitModule& split);
// Likewise rates: those of arrays stay, since only the whole program could tell them.
void assign_rates(SplitModule& split);
// Everything to the sample: what a program means without the cut.
SplitModule split_nothing(ir::Module module);

}  // namespace pse::passes
