// How each value changes with the place, by one walk over the main function.
#include "antialias/bent.h"

#include <algorithm>
#include <utility>

#include "antialias/decisions.h"
#include "antialias/fine.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// How a value changes with the place between jumps and creases, which neighbours see: not at all,
// as a linear function, as one over a linear function, as a ratio of two, or otherwise.
enum class Kind : std::uint8_t { even, linear, reciprocal, ratio, bent };
struct Form {
  Kind kind = Kind::even;
  Value by = ir::no_value;  // of ratios: the value below
  bool operator==(const Form&) const = default;
};

class Kinds {
 public:
  explicit Kinds(const ir::Function& main) : main_(main), kinds_(main.values.size()) {
    walk(main.body);
  }

  // Of what a comparison or a step decides by.
  bool is_bent(const Instruction& in) const {
    const Form a = kinds_[in.operands[0]];
    return (in.operands.size() < 2 ? a : sum(a, kinds_[in.operands[1]])).kind == Kind::bent;
  }

 private:
  static constexpr Form bent{Kind::bent};

  static Form sum(Form a, Form b) {
    if (a == b) return a;
    if (a.kind == Kind::even) std::swap(a, b);
    if (b.kind == Kind::even) return a.kind == Kind::reciprocal ? Form{Kind::ratio, a.by} : a;
    const bool are_ratios = a.by != ir::no_value && a.by == b.by;
    return are_ratios ? Form{Kind::ratio, a.by} : bent;
  }
  static Form product(Form a, Form b) {
    if (b.kind == Kind::even) return a;
    if (a.kind == Kind::even) return b;
    if (a.kind == Kind::linear && b.kind == Kind::reciprocal) return {Kind::ratio, b.by};
    if (b.kind == Kind::linear && a.kind == Kind::reciprocal) return {Kind::ratio, a.by};
    return bent;
  }
  Form quotient(const Instruction& in) const {
    const Form a = kinds_[in.operands[0]], b = kinds_[in.operands[1]];
    if (b.kind == Kind::even) return a;
    if (b.kind != Kind::linear || a.kind > Kind::linear) return bent;
    return {a.kind == Kind::even ? Kind::reciprocal : Kind::ratio, in.operands[1]};
  }
  // One or the other, by pieces.
  static Form either(Form a, Form b) {
    if (a == b || b.kind == Kind::even) return a;
    if (a.kind == Kind::even) return b;
    return a.kind == Kind::bent || b.kind == Kind::bent ? bent : Form{Kind::ratio};
  }

  Form form_of(const Instruction& in) const {
    const auto of = [&](std::size_t k) { return kinds_[in.operands[k]]; };
    const auto any = [&](std::size_t from) {
      Form form;
      for (std::size_t k = from; k < in.operands.size(); ++k) form = either(form, of(k));
      return form;
    };
    switch (in.op) {
      case Op::input:
        return {Kind::linear};
      case Op::fadd:
      case Op::fsub:
        return sum(of(0), of(1));
      case Op::fmul:
        return product(of(0), of(1));
      case Op::fma:
        return sum(product(of(0), of(1)), of(2));
      case Op::fdiv:
        return quotient(in);
      case Op::fneg:
      case Op::fabs:
      case Op::fmin:
      case Op::fmax:
        return any(0);
      case Op::select:
        return any(1);
      default:
        // Steps, comparisons and whole numbers change by jumps alone.
        if (main_.values[in.result()].type != ir::Type::f32 || cut_of(in.op) != Cut::none ||
            in.op == Op::i2f)
          return {};
        return any(0).kind == Kind::even ? Form{} : bent;
    }
  }

  void walk(const Region& region) {
    for (const Instruction& in : region.body) {
      if (in.op == Op::loop) {
        turn(in);
      } else if (in.op == Op::if_) {
        for (const Region& inner : in.regions) walk(inner);
        for (std::size_t k = 0; k < in.results.size(); ++k)
          kinds_[in.results[k]] =
              either(kinds_[in.regions[0].yields[k]], kinds_[in.regions[1].yields[k]]);
      } else if (!in.results.empty()) {
        const bool differs = main_.values[in.results[0]].rate == ir::Rate::sample;
        const Form form = differs ? form_of(in) : Form{};
        for (const Value result : in.results) kinds_[result] = form;
      }
    }
  }

  // Until the turns make no more of what they hand on.
  void turn(const Instruction& loop) {
    const Region &head = loop.regions[0], &body = loop.regions[1];
    for (std::size_t k = 0; k < loop.results.size(); ++k)
      kinds_[loop.results[k]] = kinds_[loop.operands[k]];
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t k = 0; k < loop.results.size(); ++k)
        kinds_[head.params[k]] = kinds_[body.params[k]] = kinds_[loop.results[k]];
      walk(head);
      walk(body);
      for (std::size_t k = 0; k < loop.results.size(); ++k) {
        const Form after = either(kinds_[loop.results[k]], kinds_[body.yields[k]]);
        changed = changed || after != kinds_[loop.results[k]];
        kinds_[loop.results[k]] = after;
      }
    }
  }

  const ir::Function& main_;
  std::vector<Form> kinds_;
};

void mark_bent(const Region& region, const Kinds& kinds, const Decisions& decisions,
               std::vector<bool>& bent) {
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) mark_bent(inner, kinds, decisions, bent);
    if (in.results.size() != 1 || !decisions.forks[in.result()]) continue;
    bent[in.result()] = cut_of(in.op) != Cut::kink && kinds.is_bent(in);
  }
}

}  // namespace

std::vector<bool> find_bent(const ir::Module& module, const Decisions& decisions,
                            const InputChanges& changes) {
  const ir::Function& main = module.main();
  std::vector<bool> bent(main.values.size());
  mark_bent(main.body, Kinds(main), decisions, bent);
  return find_cheap(module, decisions, changes, bent);
}

Value is_near(const passes::Emit& emit, const Instruction& decision, float reach) {
  const auto slope = [&](Value of, std::int32_t k) {
    return emit.function().values[of].rate == ir::Rate::sample ? emit(Op::slope, {of}, k)
                                                               : emit.number(0);
  };
  const Value a = decision.operands[0];
  Value f = a, along_x = slope(a, 0), along_y = slope(a, 1);
  const Cut cut = cut_of(decision.op);
  if (cut == Cut::compare) {
    const Value b = decision.operands[1];
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
