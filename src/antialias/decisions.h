// Where a program's value jumps or bends: the conditionals of the 2002 chapter's "Antialiased
// rendering of procedural textures", and what else makes an edge. Looked for before calls are
// inlined, when the program's own statements, library functions included, stand in the main
// function and the bodies of builtins (whose floors and choices are continuous as a whole) in
// functions of their own.
#pragma once

#include <vector>

#include "antialias/fine.h"
#include "ir/module.h"
#include "stream/sample_source.h"

namespace pse::antialias {

enum class Cut : std::uint8_t {
  none,
  compare,  // a < b, a <= b: jumps where a - b is 0
  whole,    // floor, ceil, trunc, conversion to an integer: jumps at whole numbers
  half,     // round: jumps halfway between them
  kink,     // min, max, abs: bends where a - b, or a, is 0
};
Cut cut_of(ir::Op op);

// By value: whether an instruction of the function gives it.
std::vector<bool> defined_values(const ir::Function& function);

// The cuts of the main function that differ from sample to sample, by the value that they give.
struct Decisions {
  // Jumps, and min and max that an output shows otherwise than by a jump: a steep clamp is an edge
  // to the eye.
  std::vector<bool> forks;
  std::vector<bool> bends;  // abs, and other min and max, where a jump depends on it: edges bend
  // Of these and of steps, those that a jump is computed from: a line that is thinner than a pixel
  // may lie on one. None that fold the octaves of a sum of noise, or that only choose a random
  // number.
  std::vector<bool> creases;
  std::vector<bool> dithered;  // what depends on chance (dither.h): none of these is an edge
  std::vector<bool> expected;  // what expectations alone need (ir/expectations.h): likewise none
  std::vector<bool> searched;  // the conditions of loops that search
  std::vector<bool> ends;      // the results of these that are used
  // By their first result, the calls that send rays (docs/surfaces.md): what these meet jumps where
  // shadows and reflections have edges.
  std::vector<bool> rays;
  Noises noises;           // what may be finer than a pixel (fine.h)
  std::vector<bool> bent;  // jumps that no pixel's middle may show (bent.h)
  bool any = false;        // whether there is a fork, or a ray
  bool any_jump = false;
  bool any_noise = false;
  bool any_bent = false;

  // Whether an if or a loop goes its way by chance, and with it all that stands inside.
  bool is_dither(const ir::Instruction& in) const {
    if (in.op != ir::Op::if_ && in.op != ir::Op::loop) return false;
    const ir::Value by = in.op == ir::Op::if_ ? in.operands[0] : in.regions[0].yields[0];
    return by < dithered.size() && dithered[by];
  }

  // Whether a loop searches, as a ray's march does: how often it turns hangs on what its turns hand
  // on to each other and differs from sample to sample, but nothing that it ends with counts the
  // turns. Ending a turn earlier or later is no edge then; ending elsewhere is.
  bool is_search(const ir::Instruction& in) const {
    if (in.op != ir::Op::loop) return false;
    const ir::Value by = in.regions[0].yields[0];
    return by < searched.size() && searched[by];
  }
};

// Gives the module's values their rates and lays seams open (seams.h), and finds the decisions.
// `changes`: as in compile_programs().
Decisions find_decisions(ir::Module& module, const InputChanges& changes = unknown_changes);

}  // namespace pse::antialias
