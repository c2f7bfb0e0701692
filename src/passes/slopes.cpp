// Puts derivatives in the place of `slope` instructions: what Dx, Dy and filterwidth ask for. Only
// what the slopes are computed from is derived, and what comes out unused goes with the dead code.
#include "passes/deriver.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

void need_asked(const ir::Region& region, Slice& slice) {
  for (const ir::Instruction& in : region.body) {
    if (in.op == ir::Op::slope) slice.need(in.operands[0]);
    for (const ir::Region& inner : in.regions) need_asked(inner, slice);
  }
}

void forget(ir::Region& region) {
  for (ir::Instruction& in : region.body) {
    if (in.op == ir::Op::slope)
      in = {.op = ir::Op::const_f32, .results = in.results, .imm = 0, .span = in.span};
    for (ir::Region& inner : in.regions) forget(inner);
  }
}

}  // namespace

bool asks_when_folded(ir::Module module) {
  // Most that have it in such branches only are known by their constants.
  fold(module);
  if (!asks_for_slopes(module.main().body)) return false;
  decide(module);
  fold(module);
  remove_dead(module);
  return asks_for_slopes(module.main().body);
}

void forget_slopes(ir::Module& module) { forget(module.main().body); }

void resolve_slopes(ir::Module& module) {
  if (!asks_for_slopes(module.main().body)) return;
  const ir::Function before = module.main();
  Slice slice(before);
  need_asked(before.body, slice);
  slice.run();
  std::vector<SlopesOfInput> inputs;
  for (const ir::Input& input : module.inputs) inputs.push_back({input.slopes, input.slopes});
  derive_main(module, inputs, {.needed = &slice});
}

}  // namespace pse::passes
