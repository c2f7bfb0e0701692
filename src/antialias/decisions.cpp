// Finding cuts by operator and rate, and the kinks that bend them by what they are computed from.
#include "antialias/decisions.h"

#include <algorithm>

#include "antialias/dither.h"
#include "antialias/searches.h"
#include "passes/passes.h"
#include "passes/slice.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// All instructions but those inside of dither.
template <class Visit>
void for_each(const Region& region, const Decisions& found, const Visit& visit) {
  for (const Instruction& in : region.body) {
    visit(in);
    if (found.is_dither(in)) continue;
    for (const Region& inner : in.regions) for_each(inner, found, visit);
  }
}

}  // namespace

Cut cut_of(Op op) {
  switch (op) {
    case Op::flt:
    case Op::fle:
      return Cut::compare;
    case Op::ffloor:
    case Op::fceil:
    case Op::ftrunc:
    case Op::f2i:
      return Cut::whole;
    case Op::fround:
      return Cut::half;
    case Op::fmin:
    case Op::fmax:
    case Op::fabs:
      return Cut::kink;
    default:
      return Cut::none;
  }
}

Decisions find_decisions(ir::Module& module) {
  passes::assign_rates(module);
  const Function& main = module.main();
  Decisions found;
  found.forks.resize(main.values.size());
  found.bends.resize(main.values.size());
  passes::Slice bends(main);
  // Dither is no edge: it decides anew in each pixel, and a ray marcher with a jittered step does so
  // all along its way.
  found.dithered = find_dither(module);
  const auto differs = [&](const Instruction& in) {
    return main.values[in.result()].rate == ir::Rate::sample && !found.dithered[in.result()];
  };
  for_each(main.body, found, [&](const Instruction& in) {
    const Cut cut = cut_of(in.op);
    if (cut == Cut::none || in.op == Op::fabs || !differs(in)) return;
    found.forks[in.result()] = found.any = true;
    if (cut == Cut::kink) return;
    found.any_jump = true;
    for (const Value operand : in.operands) bends.need(operand);
  });
  bends.run();
  for_each(main.body, found, [&](const Instruction& in) {
    if (in.op == Op::fabs && differs(in) && bends[in.result()]) found.bends[in.result()] = true;
  });
  find_searches(main, found);
  return found;
}

}  // namespace pse::antialias
