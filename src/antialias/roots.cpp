// By the instructions that give the values compared.
#include "antialias/roots.h"

namespace pse::antialias {

using ir::Instruction;
using ir::Op;
using ir::Value;
using passes::Emit;

Roots::Roots(const ir::Module& module) { find(module, module.main().body); }

void Roots::find(const ir::Module& module, const ir::Region& region) {
  for (const Instruction& in : region.body) {
    if (in.op == Op::const_f32) constants_[in.result()] = in.imm_f32();
    if (in.op == Op::fsqrt) roots_[in.result()] = {Kind::square, in.operands[0]};
    if (in.op == Op::call && module.functions[static_cast<std::size_t>(in.imm)].name == "cbrt")
      roots_[in.results[0]] = {Kind::cube, in.operands[0]};
    for (const ir::Region& inner : in.regions) find(module, inner);
  }
}

// A square root only where it is compared with 0, or what it never is below: elsewhere it has a
// slope like any other, and the lengths of vectors are distances.
bool Roots::opens(const Emit& emit, Value root, Value other) const {
  const auto found = roots_.find(root);
  if (found == roots_.end()) return false;
  if (found->second.kind == Kind::cube)
    return emit.function().values[other].rate != ir::Rate::sample;
  const auto constant = constants_.find(other);
  return constant != constants_.end() && constant->second <= 0;
}

Roots::Sides Roots::under(const Emit& emit, Sides sides) const {
  const auto power = [&](const Root& root, Value other) {
    return root.kind == Kind::cube ? emit.mul(emit.mul(other, other), other) : emit.number(0);
  };
  if (opens(emit, sides.a, sides.b)) {
    const Root& root = roots_.at(sides.a);
    return {root.of, power(root, sides.b)};
  }
  if (opens(emit, sides.b, sides.a)) {
    const Root& root = roots_.at(sides.b);
    return {power(root, sides.a), root.of};
  }
  return sides;
}

}  // namespace pse::antialias
