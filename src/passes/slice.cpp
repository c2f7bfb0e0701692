// Rounds over the function, backwards.
#include "passes/slice.h"

namespace pse::passes {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

void Slice::run() {
  do {
    changed_ = false;
    walk(function_.body);
  } while (changed_);
}

void Slice::mark(Value value) {
  if (needed_[value]) return;
  needed_[value] = true;
  changed_ = true;
}

void Slice::walk(const Region& region) {
  for (auto in = region.body.rbegin(); in != region.body.rend(); ++in) visit(*in);
}

void Slice::visit(const Instruction& in) {
  if (in.op == Op::if_) {
    for (std::size_t i = 0; i < in.results.size(); ++i)
      if (needed_[in.results[i]])
        for (const Region& region : in.regions) mark(region.yields[i]);
  } else if (in.op == Op::loop) {
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      if (!needed_[in.results[i]] && !needed_[in.regions[0].params[i]] &&
          !needed_[in.regions[1].params[i]])
        continue;
      mark(in.results[i]), mark(in.regions[0].params[i]), mark(in.regions[1].params[i]);
      mark(in.operands[i]), mark(in.regions[1].yields[i]);
    }
  } else if (in.op == Op::array_store) {
    if (arrays_[static_cast<std::size_t>(in.imm)]) mark(in.operands[1]);
  } else {
    bool wanted = false;
    for (const Value result : in.results) wanted = wanted || (needed_[result] && !ends_[result]);
    // A number made of whole ones is a count or a hash, as good as a call's result.
    if (!wanted || (!through_calls_ && (in.op == Op::call || in.op == Op::i2f))) return;
    for (const Value operand : in.operands) mark(operand);
    if (in.op == Op::array_load && !arrays_[static_cast<std::size_t>(in.imm)])
      arrays_[static_cast<std::size_t>(in.imm)] = changed_ = true;
  }
  for (const Region& region : in.regions) walk(region);
}

}  // namespace pse::passes
