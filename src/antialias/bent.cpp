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

SlopeBounds::SlopeBounds(const ir::Module& module, const Decisions& decisions)
    : forms_(find_forms(module, decisions, Folds::seen)), definitions_(forms_.size()) {
  define(module.main().body);
}

void SlopeBounds::define(const Region& region) {
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) define(inner);
    if (in.results.size() == 1) definitions_[in.result()] = {in.op, in.operands};
  }
}

// Whether a value is a sum of squares of what is linear; adds these.
bool SlopeBounds::add_squares(Value value, std::vector<Value>& of) const {
  const auto& [op, operands] = definitions_[value];
  if (op == Op::fadd) return add_squares(operands[0], of) && add_squares(operands[1], of);
  if ((op != Op::fmul && op != Op::fma) || operands[0] != operands[1]) return false;
  if (forms_[operands[0]].kind > Kind::linear) return false;
  of.push_back(operands[0]);
  return op == Op::fmul || add_squares(operands[2], of);
}

std::optional<Value> SlopeBounds::of(const passes::Emit& emit, Value value) const {
  if (value >= forms_.size()) return std::nullopt;
  if (is_even(value)) return emit.number(0);
  const auto& [op, operands] = definitions_[value];
  const auto both = [&](Op with) -> std::optional<Value> {
    const auto a = of(emit, operands[0]), b = of(emit, operands[1]);
    return a && b ? std::optional(emit(with, {*a, *b})) : std::nullopt;
  };
  // Times what is the same everywhere.
  const auto times = [&](Op with, Value part, Value factor) -> std::optional<Value> {
    const auto bound = is_even(factor) ? of(emit, part) : std::nullopt;
    return bound ? std::optional(emit(with, {*bound, emit(Op::fabs, {factor})})) : std::nullopt;
  };
  switch (op) {
    case Op::fabs:
    case Op::fneg:
      return of(emit, operands[0]);
    case Op::fadd:
    case Op::fsub:
      return both(Op::fadd);
    case Op::fmin:
    case Op::fmax:
      return both(Op::fmax);
    case Op::fmul:
      return is_even(operands[0]) ? times(Op::fmul, operands[1], operands[0])
                                  : times(Op::fmul, operands[0], operands[1]);
    case Op::fdiv:
      return times(Op::fdiv, operands[0], operands[1]);
    case Op::fsqrt: {
      std::vector<Value> places;
      if (!add_squares(operands[0], places)) return std::nullopt;
      // The largest stretch of a pixel's way: of these slopes as a matrix of two columns.
      Value along = emit.number(0), across = along, mixed = along;
      for (const Value place : places) {
        if (is_even(place)) continue;
        const Value x = emit(Op::slope, {place}, 0), y = emit(Op::slope, {place}, 1);
        along = emit(Op::fma, {x, x, along}), across = emit(Op::fma, {y, y, across});
        mixed = emit(Op::fma, {x, y, mixed});
      }
      const Value apart = emit.sub(along, across), twice = emit.mul(mixed, emit.number(2));
      const Value slant = emit(Op::fsqrt, {emit(Op::fma, {apart, apart, emit.mul(twice, twice)})});
      return emit(Op::fsqrt,
                  {emit.mul(emit.add(emit.add(along, across), slant), emit.number(0.5f))});
    }
    default:
      return std::nullopt;
  }
}

Value is_near(const passes::Emit& emit, const Instruction& decision, const Roots& roots,
              const SlopeBounds& bounds, float reach) {
  const auto slope = [&](Value of, std::int32_t k) {
    return emit.function().values[of].rate == ir::Rate::sample ? emit(Op::slope, {of}, k)
                                                               : emit.number(0);
  };
  const Cut cut = cut_of(decision.op);
  const bool compares = cut == Cut::compare;
  Roots::Sides sides{decision.operands[0], ir::no_value};
  if (compares) sides = roots.under(emit, {sides.a, decision.operands[1]});
  const auto [a, b] = sides;
  Value f = a;
  if (compares) {
    f = emit.sub(a, b);
  } else {
    // To the nearer step.
    const Value shifted = cut == Cut::half ? emit.sub(a, emit.number(0.5f)) : a;
    f = emit.sub(shifted, emit(Op::fround, {shifted}));
  }
  const auto of_a = bounds.of(emit, a);
  const auto of_b = compares ? bounds.of(emit, b) : emit.number(0);
  if (of_a && of_b) {
    const Value steepest = emit.add(*of_a, *of_b);
    return emit.less(emit(Op::fabs, {f}), emit.mul(steepest, emit.number(reach)));
  }
  Value along_x = slope(a, 0), along_y = slope(a, 1);
  if (compares && emit.function().values[b].rate == ir::Rate::sample)
    along_x = emit.sub(along_x, slope(b, 0)), along_y = emit.sub(along_y, slope(b, 1));
  const Value steepness = emit(Op::fma, {along_x, along_x, emit.mul(along_y, along_y)});
  return emit.less(emit.mul(f, f), emit.mul(steepness, emit.number(reach * reach)));
}

}  // namespace pse::antialias
