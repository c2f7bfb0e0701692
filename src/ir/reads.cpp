// Walks over regions that look for inputs.
#include "ir/reads.h"

namespace pse::ir {

void mark_inputs_read(const Region& region, std::vector<bool>& read) {
  for (const Instruction& in : region.body) {
    if (in.op == Op::input) read[static_cast<std::size_t>(in.imm)] = true;
    for (const Region& inner : in.regions) mark_inputs_read(inner, read);
  }
}

std::vector<bool> inputs_read(const Module& module) {
  std::vector<bool> read(module.inputs.size());
  for (const Function& function : module.functions) mark_inputs_read(function.body, read);
  return read;
}

}  // namespace pse::ir
