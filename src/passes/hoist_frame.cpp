// Work of rate frame that stands under control of rate sample moves out to where the frame function
// can do it. It may then run where it would not have run; so only what ends and is pure moves.
#include <utility>
#include <vector>

#include "passes/hoister.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Rate;
using ir::Region;

bool has_loop(const ir::Module& module, const Region& region, std::vector<std::int8_t>& known) {
  for (const Instruction& in : region.body) {
    if (in.op == Op::loop) return true;
    if (in.op == Op::call) {
      std::int8_t& callee = known[static_cast<std::size_t>(in.imm)];
      if (callee < 0)
        callee = has_loop(module, module.functions[static_cast<std::size_t>(in.imm)].body, known);
      if (callee != 0) return true;
    }
    for (const Region& inner : in.regions) {
      if (has_loop(module, inner, known)) return true;
    }
  }
  return false;
}

}  // namespace

void hoist_frame(ir::Module& module) {
  ir::Function& function = module.main();
  std::vector<std::int8_t> known(module.functions.size(), -1);
  const auto may_move = [&](const Instruction& in) {
    if (in.results.empty() || function.values[in.result()].rate == Rate::sample) return false;
    if (is_cheap_and_pure(in.op) || in.op == Op::external) return true;
    if (in.op != Op::call) return false;
    const auto callee = static_cast<std::size_t>(in.imm);
    if (known[callee] < 0) known[callee] = has_loop(module, module.functions[callee].body, known);
    return known[callee] == 0;
  };
  const auto of_sample = [&](const HoistRegion& region) {
    return function.values[region.condition].rate == Rate::sample;
  };
  const auto choose = [&](const HoistPlace& place) {
    const std::size_t here = place.path.size() - 1;
    // Where the operands are must be a place of rate frame, outside of loops: only then the frame
    // gives one value.
    for (std::size_t depth = 1; depth <= place.operand_depth; ++depth) {
      if (place.path[depth].is_loop || of_sample(place.path[depth])) return here;
    }
    for (std::size_t depth = place.operand_depth + 1; depth <= here; ++depth) {
      if (of_sample(place.path[depth])) return place.operand_depth;
    }
    return here;
  };
  Hoister(function, choose).run(may_move);
}

}  // namespace pse::passes
