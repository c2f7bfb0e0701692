// A program that computes bounds: what its outputs can be at all places of a box at once, with
// proof. Every value that depends on the place becomes an interval that holds all it can be;
// conditions that the box does not decide run both sides. From there an empty stretch of a ray is
// known to be empty, however thin the matter that a sample would miss. DESIGN.md, section 4
// ("room for an interval evaluator"); 2002 chapter, "Smoke", "Optimization", which samples instead.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "ir/module.h"

namespace pse::bounds {

struct Options {
  // Inputs of frame rate that are known: the program is cut to them.
  std::map<std::string, float> known;
  // A loop whose end the box does not decide stops after so many turns, and what it carries is
  // then anything.
  std::int32_t max_turns = 256;
};

// Makes a module fresh from the lowering give the bounds of its outputs. For every input NAME of
// sample rate it reads "NAME$lo" and "NAME$hi", for every output NAME it gives "NAME$lo" and
// "NAME$hi": each float that the program can compute for inputs in these intervals, its roundings
// included, lies between them. NaN is possible only where they are -infinity and infinity. What
// cannot be bounded (functions of the host, integers taken from numbers) is anything; checks
// and expectations are left out.
void bound_outputs(ir::Module& module, const Options& options = {});

}  // namespace pse::bounds
