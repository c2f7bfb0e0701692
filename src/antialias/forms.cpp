// One walk through the main function with what is known of each value; loops until nothing changes.
#include "antialias/forms.h"

#include <algorithm>
#include <utility>

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

constexpr Form bent{Kind::bent};

Form product(Form a, Form b) {
  if (b.kind == Kind::constant) return a;
  if (a.kind == Kind::constant) return b;
  if (a.kind == Kind::linear && b.kind == Kind::reciprocal) return {Kind::ratio, b.by};
  if (b.kind == Kind::linear && a.kind == Kind::reciprocal) return {Kind::ratio, a.by};
  return bent;
}

Form quotient(Form a, Form b, Value by) {
  if (b.kind == Kind::constant) return a;
  if (b.kind != Kind::linear || a.kind > Kind::linear) return bent;
  return {a.kind == Kind::constant ? Kind::reciprocal : Kind::ratio, by};
}

// One or the other, by pieces.
Form either(Form a, Form b) {
  if (a == b || b.kind == Kind::constant) return a;
  if (a.kind == Kind::constant) return b;
  return a.kind == Kind::bent || b.kind == Kind::bent ? bent : Form{Kind::ratio};
}

class FormWalk {
 public:
  FormWalk(const ir::Module& module, const Decisions& decisions, Folds folds)
      : module_(module),
        main_(module.main()),
        decisions_(decisions),
        folds_(folds),
        forms_(main_.values.size()) {}

  std::vector<Form> find() && {
    walk(main_.body);
    return std::move(forms_);
  }

 private:
  void set(Value value, Form form) {
    forms_[value] = main_.values[value].rate == ir::Rate::sample ? form : Form{};
  }

  void walk(const Region& region) {
    for (const Instruction& in : region.body) {
      if (in.op == Op::loop) {
        turn(in);
      } else if (in.op == Op::if_) {
        for (const Region& inner : in.regions) walk(inner);
        for (std::size_t k = 0; k < in.results.size(); ++k)
          set(in.results[k],
              either(forms_[in.regions[0].yields[k]], forms_[in.regions[1].yields[k]]));
      } else if (!in.results.empty()) {
        const Form form = form_of(in);
        for (const Value result : in.results) set(result, form);
      }
    }
  }

  // Until the turns make no more of what they hand on.
  void turn(const Instruction& loop) {
    const Region &head = loop.regions[0], &body = loop.regions[1];
    std::vector<Form> handed(loop.results.size(), bent);
    if (!decisions_.is_search(loop))
      for (std::size_t k = 0; k < handed.size(); ++k) handed[k] = forms_[loop.operands[k]];
    for (bool changed = true; changed;) {
      for (std::size_t k = 0; k < handed.size(); ++k)
        for (const Value value : {head.params[k], body.params[k], loop.results[k]})
          set(value, handed[k]);
      walk(head);
      walk(body);
      changed = false;
      for (std::size_t k = 0; k < handed.size(); ++k) {
        const Form after = either(handed[k], forms_[body.yields[k]]);
        changed = changed || after != handed[k];
        handed[k] = after;
      }
    }
  }

  Form form_of(const Instruction& in) const {
    const auto of = [&](std::size_t k) { return forms_[in.operands[k]]; };
    const bool is_constant = std::ranges::all_of(
        in.operands, [&](Value operand) { return forms_[operand].kind == Kind::constant; });
    switch (in.op) {
      case Op::input:
        return {Kind::linear};
      case Op::external:
        return is_constant ? Form{} : is_end_of_ray(in) ? Form{Kind::linear} : bent;
      case Op::slope:
        return of(0).kind <= Kind::linear ? Form{} : bent;
      case Op::fadd:
      case Op::fsub:
        return sum(of(0), of(1));
      case Op::fmul:
        return product(of(0), of(1));
      case Op::fma:
        return sum(product(of(0), of(1)), of(2));
      case Op::fdiv:
        return quotient(of(0), of(1), in.operands[1]);
      case Op::fneg:
        return of(0);
      case Op::fabs:
        return is_constant || folds_ == Folds::seen ? of(0) : bent;
      case Op::fmin:
      case Op::fmax:  // which of the two is told by the path
        return either(of(0), of(1));
      case Op::select:
        return either(of(1), of(2));
      case Op::array_load:
      case Op::array_length:
        return bent;
      default:
        return is_constant || cut_of(in.op) != Cut::none ? Form{} : bent;
    }
  }

  bool is_end_of_ray(const Instruction& in) const {
    const std::string& name = module_.externals[static_cast<std::size_t>(in.imm)].name;
    return name.starts_with("trace") || name.starts_with("visible");
  }

  const ir::Module& module_;
  const ir::Function& main_;
  const Decisions& decisions_;
  const Folds folds_;
  std::vector<Form> forms_;
};

}  // namespace

Form sum(Form a, Form b) {
  if (a == b) return a;
  if (a.kind == Kind::constant) std::swap(a, b);
  if (b.kind == Kind::constant) return a.kind == Kind::reciprocal ? Form{Kind::ratio, a.by} : a;
  const bool are_ratios = a.by != ir::no_value && a.by == b.by;
  return are_ratios ? Form{Kind::ratio, a.by} : bent;
}

std::vector<Form> find_forms(const ir::Module& module, const Decisions& decisions, Folds folds) {
  return FormWalk(module, decisions, folds).find();
}

}  // namespace pse::antialias
