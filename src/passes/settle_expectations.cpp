// Expectations become effects. Until then they hand values on (ir/expectations.h), so that the
// first remove-dead drops those of outputs that nobody wants. From here on the values go their way
// as without them: whoever asks what a value depends on, or how it changes, does not meet them.
#include <algorithm>

#include "ir/expectations.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Module;
using ir::Op;
using ir::Region;
using ir::Value;

class Settling {
 public:
  explicit Settling(Module& module) : module_(module) {}

  // Puts the effect before each call, which itself stays for release_expected_values().
  void walk(Function& function, Region& region) {
    std::vector<Instruction> out;
    out.reserve(region.body.size());
    for (Instruction& in : region.body) {
      for (Region& inner : in.regions) walk(function, inner);
      if (!in.results.empty() && ir::is_expectation(module_, in)) report(function, in, out);
      out.push_back(std::move(in));
    }
    region.body = std::move(out);
  }

 private:
  // if condition != 0 {} else { external (px, py) }
  void report(Function& function, const Instruction& call, std::vector<Instruction>& out) {
    const auto emit = [&](Op op, std::vector<Value> operands, ir::Type type, std::int32_t imm,
                          std::vector<Instruction>& to) {
      const Value value = function.add_value(type);
      to.push_back({.op = op,
                    .operands = std::move(operands),
                    .results = {value},
                    .imm = imm,
                    .span = call.span});
      return value;
    };
    const Value zero = emit(Op::const_f32, {}, ir::Type::f32, 0, out);
    const Value holds = emit(Op::fne, {call.operands[0], zero}, ir::Type::boolean, 0, out);
    Instruction branch{.op = Op::if_, .operands = {holds}, .span = call.span};
    branch.regions.resize(2);
    std::vector<Instruction>& fails = branch.regions[1].body;
    const Value px = emit(Op::input, {}, ir::Type::f32, input("px"), fails);
    const Value py = emit(Op::input, {}, ir::Type::f32, input("py"), fails);
    fails.push_back({.op = Op::external,
                     .operands = {px, py},
                     .imm = effect_of(static_cast<std::size_t>(call.imm)),
                     .span = call.span});
    out.push_back(std::move(branch));
  }

  std::int32_t input(const char* name) {
    auto& inputs = module_.inputs;
    auto found = std::ranges::find(inputs, name, &ir::Input::name);
    if (found == inputs.end())
      found = inputs.insert(inputs.end(), {name, ir::Rate::sample, ir::InputSlopes::of_frame});
    return static_cast<std::int32_t>(found - inputs.begin());
  }

  // The external of the same name that takes a pixel and gives nothing.
  std::int32_t effect_of(std::size_t external) {
    auto& all = module_.externals;
    const std::string name = all[external].name;
    auto found = std::ranges::find_if(
        all, [&](const ir::External& other) { return other.name == name && other.results == 0; });
    if (found == all.end()) found = all.insert(all.end(), {name, 2, 0});
    return static_cast<std::int32_t>(found - all.begin());
  }

  Module& module_;
};

}  // namespace

void settle_expectations(Module& module) {
  Settling settling(module);
  for (Function& function : module.functions) settling.walk(function, function.body);
  ir::release_expected_values(module);
}

}  // namespace pse::passes
