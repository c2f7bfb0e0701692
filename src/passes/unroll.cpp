// Short loops whose number of turns is known become straight code: what they count is then
// constant, and an octave's division by a power of two a multiplication. Only where the result
// stays small, since compile time counts too.
#include <optional>
#include <utility>

#include "ir/count.h"
#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class Unroller {
 public:
  Unroller(Function& function, const UnrollOptions& options)
      : function_(function),
        options_(options),
        renaming_(function.values.size()),
        definitions_(function.values.size()) {}

  void run() { walk(function_.body); }

 private:
  // What is known of a value: a constant integer, or one of the forms of a counter.
  struct Definition {
    Op op = Op::loop;
    std::int32_t imm = 0;
    Value operands[2] = {ir::no_value, ir::no_value};
  };

  void walk(Region& region) {
    std::vector<Instruction> out;
    out.reserve(region.body.size());
    for (Instruction& in : region.body) {
      renaming_.apply(in.operands);
      for (Region& inner : in.regions) walk(inner);
      note(in);
      const auto turns = in.op == Op::loop ? count_turns(in) : std::nullopt;
      if (turns &&
          *turns * (1 + ir::count_instructions(in.regions[1])) <= options_.max_instructions) {
        unroll(in, *turns, out);
      } else {
        out.push_back(std::move(in));
      }
    }
    region.body = std::move(out);
    renaming_.apply(region.yields);
  }

  void note(const Instruction& in) {
    if (in.results.size() != 1 || in.operands.size() > 2) return;
    Definition& definition = definitions_[in.result()];
    definition.op = in.op;
    definition.imm = in.imm;
    for (std::size_t i = 0; i < in.operands.size(); ++i) definition.operands[i] = in.operands[i];
  }

  Definition definition(Value value) const {
    return value < definitions_.size() ? definitions_[value] : Definition{};
  }
  std::optional<std::int64_t> integer(Value value) const {
    const Definition found = definition(value);
    if (found.op == Op::const_i32) return found.imm;
    return {};
  }

  // For a loop that counts from a constant by a constant to a constant, and whose head does nothing
  // else.
  std::optional<std::size_t> count_turns(const Instruction& loop) const {
    const Region& head = loop.regions[0];
    for (const Instruction& in : head.body) {
      if (!is_cheap_and_pure(in.op)) return {};
    }
    const Definition condition = definition(head.yields[0]);
    if (condition.op != Op::ilt && condition.op != Op::ile) return {};
    const auto limit = integer(condition.operands[1]);
    for (std::size_t i = 0; limit && i < head.params.size(); ++i) {
      if (head.params[i] != condition.operands[0]) continue;
      const auto start = integer(loop.operands[i]);
      const Definition next = definition(loop.regions[1].yields[i]);
      const auto step = integer(next.operands[1]);
      if (!start || !step || next.op != Op::iadd || next.operands[0] != loop.regions[1].params[i])
        return {};
      const std::int64_t last = condition.op == Op::ilt ? *limit - 1 : *limit;
      if (*step <= 0 || last + *step > INT32_MAX) return {};
      return last < *start ? 0 : static_cast<std::size_t>((last - *start) / *step) + 1;
    }
    return {};
  }

  void unroll(const Instruction& loop, std::size_t turns, std::vector<Instruction>& out) {
    const Region& body = loop.regions[1];
    std::vector<Value> carried = loop.operands;
    for (std::size_t turn = 0; turn < turns; ++turn) {
      Cloner cloner(function_);
      for (std::size_t i = 0; i < carried.size(); ++i) cloner.set(body.params[i], carried[i]);
      for (const Instruction& in : body.body) out.push_back(cloner.clone(in));
      for (std::size_t i = 0; i < carried.size(); ++i) carried[i] = cloner(body.yields[i]);
    }
    for (std::size_t i = 0; i < carried.size(); ++i) renaming_.set(loop.results[i], carried[i]);
  }

  Function& function_;
  const UnrollOptions& options_;
  Renaming renaming_;
  std::vector<Definition> definitions_;
};

}  // namespace

void unroll(ir::Module& module, const UnrollOptions& options) {
  for (Function& function : module.functions) Unroller(function, options).run();
}

}  // namespace pse::passes
