// Calls of constants, through the interpreter. See the header.
#include "passes/constant_calls.h"

namespace pse::passes {

constexpr std::uint64_t max_turns = 200;

ConstantCalls::ConstantCalls(const ir::Module& module)
    : module_(module), interpreter_(module), sizes_(module.functions.size()) {}

const ConstantCalls::Size& ConstantCalls::measure(std::uint32_t function) {
  if (!sizes_[function].known) {
    Size size{.known = true};
    measure(module_.functions[function].body, size);
    sizes_[function] = size;
  }
  return sizes_[function];
}

void ConstantCalls::measure(const ir::Region& region, Size& size) {
  for (const ir::Instruction& in : region.body) {
    size.instructions += 1;
    if (in.op == ir::Op::external) size.has_external = true;
    if (in.op == ir::Op::call) {
      const Size callee = measure(static_cast<std::uint32_t>(in.imm));
      size.instructions += callee.instructions;
      size.has_external = size.has_external || callee.has_external;
    }
    for (const ir::Region& inner : in.regions) measure(inner, size);
  }
}

std::optional<std::vector<ir::Bits>> ConstantCalls::run(std::uint32_t function,
                                                        const std::vector<ir::Bits>& arguments) {
  const Size size = measure(function);
  // A loop may turn each of its instructions as often as it is let.
  const double most = size.instructions * static_cast<double>(max_turns);
  if (size.has_external || most > work_left_) return {};
  work_left_ -= size.instructions;
  std::vector<ir::Bits> results(module_.functions[function].body.yields.size());
  const ir::Environment environment{.max_turns = max_turns};
  const ir::Outcome outcome = interpreter_.run(function, arguments, environment, results);
  if (outcome.end == ir::End::finished) return results;
  work_left_ -= most;
  return {};
}

}  // namespace pse::passes
