// Which decisions are bent, by the forms of what they compare, and how near their edges are.
#include "antialias/bent.h"

#include "antialias/decisions.h"
#include "antialias/fine.h"
#include "antialias/forms.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// Of what a comparison or a step decides by.
bool is_bent(const Instruction& in, const std::vector<Form>& forms) {
  const Form a = forms[in.operands[0]];
  return (in.operands.size() < 2 ? a : sum(a, forms[in.operands[1]])).kind == Kind::bent;
}

void mark_bent(const Region& region, const std::vector<Form>& forms, const Decisions& decisions,
               std::vector<bool>& bent) {
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) mark_bent(inner, forms, decisions, bent);
    if (in.results.size() != 1 || !decisions.forks[in.result()]) continue;
    bent[in.result()] = cut_of(in.op) != Cut::kink && is_bent(in, forms);
  }
}

}  // namespace

std::vector<bool> find_bent(const ir::Module& module, const Decisions& decisions,
                            const InputChanges& changes) {
  const ir::Function& main = module.main();
  std::vector<bool> bent(main.values.size());
  mark_bent(main.body, find_forms(module, decisions, Folds::seen), decisions, bent);
  return find_cheap(module, decisions, changes, bent);
}

Value is_near(const passes::Emit& emit, const Instruction& decision, const Roots& roots,
              float reach) {
  const auto slope = [&](Value of, std::int32_t k) {
    return emit.function().values[of].rate == ir::Rate::sample ? emit(Op::slope, {of}, k)
                                                               : emit.number(0);
  };
  const Cut cut = cut_of(decision.op);
  Roots::Sides sides{decision.operands[0], ir::no_value};
  if (cut == Cut::compare) sides = roots.under(emit, {sides.a, decision.operands[1]});
  const auto [a, b] = sides;
  Value f = a, along_x = slope(a, 0), along_y = slope(a, 1);
  if (cut == Cut::compare) {
    f = emit.sub(a, b);
    if (emit.function().values[b].rate == ir::Rate::sample)
      along_x = emit.sub(along_x, slope(b, 0)), along_y = emit.sub(along_y, slope(b, 1));
  } else {
    // To the nearer step.
    const Value shifted = cut == Cut::half ? emit.sub(a, emit.number(0.5f)) : a;
    f = emit.sub(shifted, emit(Op::fround, {shifted}));
  }
  const Value steepness = emit(Op::fma, {along_x, along_x, emit.mul(along_y, along_y)});
  return emit.less(emit.mul(f, f), emit.mul(steepness, emit.number(reach * reach)));
}

}  // namespace pse::antialias
