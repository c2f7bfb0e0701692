// Loops whose condition is false at once, and values that a loop carries without changing them.
#include <optional>
#include <unordered_map>
#include <utility>

#include "ir/evaluate.h"
#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Bits;
using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class LoopSimplifier {
 public:
  LoopSimplifier(const ir::Module& module, Function& function)
      : module_(module), renaming_(function.values.size()), constants_(function.values.size()) {}

  void run(Function& function) { walk(function.body); }

 private:
  void walk(Region& region) {
    std::size_t next = 0;
    for (Instruction& in : region.body) {
      renaming_.apply(in.operands);
      if (is_constant(in.op)) constants_[in.result()] = static_cast<Bits>(in.imm);
      if (in.op == Op::loop) {
        if (never_turns(in)) {
          for (std::size_t i = 0; i < in.results.size(); ++i)
            renaming_.set(in.results[i], in.operands[i]);
          continue;
        }
        keep_unchanged_outside(in);
      }
      for (Region& inner : in.regions) walk(inner);
      Instruction& place = region.body[next++];
      if (&place != &in) place = std::move(in);
    }
    region.body.resize(next);
    renaming_.apply(region.yields);
  }

  // Evaluates the head once with what is known of the initial values. Only where it has no effects.
  bool never_turns(const Instruction& loop) {
    const Region& head = loop.regions[0];
    for (const Instruction& in : head.body) {
      if (!is_cheap_and_pure(in.op)) return false;
    }
    // Values of the head are known only for this look at it.
    std::unordered_map<Value, Bits> known;
    const auto constant = [&](Value value) -> std::optional<Bits> {
      const auto found = known.find(value);
      return found != known.end() ? found->second : constants_[value];
    };
    for (std::size_t i = 0; i < loop.operands.size(); ++i) {
      if (const auto bits = constant(loop.operands[i])) known[head.params[i]] = *bits;
    }
    for (const Instruction& in : head.body) {
      if (const auto bits = evaluate(in, constant)) known[in.result()] = *bits;
    }
    return constant(head.yields[0]) == Bits{0};
  }

  template <typename Constant>
  std::optional<Bits> evaluate(const Instruction& in, const Constant& constant) const {
    if (in.op == Op::const_bool) return in.imm != 0;
    if (is_constant(in.op)) return static_cast<Bits>(in.imm);
    if (in.op == Op::input) return {};
    Bits operands[3] = {};
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < in.operands.size(); ++i) {
      const auto bits = constant(in.operands[i]);
      operands[i] = bits.value_or(0);
      if (!bits) ++unknown;
      // One false side is enough.
      if (in.op == Op::band && bits == Bits{0}) return 0;
    }
    if (unknown > 0) return {};
    if (ir::is_scalar(in.op)) return ir::evaluate(in.op, operands[0], operands[1], operands[2]);
    return ir::evaluate_table(module_, in.op, in.imm, operands[0], operands[1]);
  }

  // A parameter that the body yields as it is has its initial value throughout.
  void keep_unchanged_outside(Instruction& loop) {
    Region& head = loop.regions[0];
    Region& body = loop.regions[1];
    std::size_t next = 0;
    for (std::size_t i = 0; i < loop.operands.size(); ++i) {
      const Value initial = loop.operands[i];
      if (body.yields[i] == body.params[i] || renaming_(body.yields[i]) == initial) {
        renaming_.set(head.params[i], initial);
        renaming_.set(body.params[i], initial);
        renaming_.set(loop.results[i], initial);
        continue;
      }
      loop.operands[next] = initial;
      loop.results[next] = loop.results[i];
      head.params[next] = head.params[i];
      body.params[next] = body.params[i];
      body.yields[next] = body.yields[i];
      ++next;
    }
    for (auto* values : {&loop.operands, &loop.results, &head.params, &body.params, &body.yields})
      values->resize(next);
  }

  const ir::Module& module_;
  Renaming renaming_;
  std::vector<std::optional<Bits>> constants_;
};

}  // namespace

void simplify_loops(ir::Module& module) {
  for (Function& function : module.functions) LoopSimplifier(module, function).run(function);
}

}  // namespace pse::passes
