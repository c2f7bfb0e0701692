// From definitions to uses until nothing changes; loops need a round for each value that their
// turns hand on.
#include "passes/activity.h"

#include "passes/slope_rules.h"

namespace pse::passes {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Type;
using ir::Value;

const Active& Activity::of(std::uint32_t index, const std::vector<bool>& parameters) {
  const auto key = std::pair(index, parameters);
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  const Function& function = module_.functions[index];
  Active active{
      std::vector<bool>(function.values.size()), std::vector<bool>(function.arrays.size()), {}};
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i]) active.values[function.body.params[i]] = true;
  while (walk(function, function.body, active)) {
  }
  for (const Value value : function.body.yields) active.results.push_back(active.values[value]);
  return known_.emplace(key, std::move(active)).first->second;
}

bool Activity::walk(const Function& function, const Region& region, Active& active) {
  bool changed = false;
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) changed = walk(function, inner, active) || changed;
    changed = visit(function, in, active) || changed;
  }
  return changed;
}

bool Activity::visit(const Function& function, const Instruction& in, Active& active) {
  bool changed = false;
  const auto mark = [&](Value value, bool is_active) {
    if (!is_active || active.values[value] || function.values[value].type != Type::f32) return;
    active.values[value] = changed = true;
  };
  const auto array = static_cast<std::size_t>(in.imm);
  switch (in.op) {
    case Op::input:
      mark(in.result(), static_cast<std::size_t>(in.imm) < inputs_.size() &&
                            inputs_[static_cast<std::size_t>(in.imm)]);
      break;
    case Op::if_:
      for (std::size_t i = 0; i < in.results.size(); ++i)
        for (const Region& region : in.regions)
          mark(in.results[i], active.values[region.yields[i]]);
      break;
    case Op::loop:
      for (std::size_t i = 0; i < in.results.size(); ++i) {
        const bool is_active =
            active.values[in.operands[i]] || active.values[in.regions[1].yields[i]];
        mark(in.results[i], is_active);
        for (const Region& region : in.regions) mark(region.params[i], is_active);
      }
      break;
    case Op::call: {
      std::vector<bool> parameters;
      for (const Value operand : in.operands) parameters.push_back(active.values[operand]);
      // The math library's slopes are known by name; its bodies work on bits.
      const Function& called = module_.functions[static_cast<std::size_t>(in.imm)];
      if (has_partials(called.name)) {
        for (const bool is_active : parameters) mark(in.result(), is_active);
        break;
      }
      const Active& callee = of(static_cast<std::uint32_t>(in.imm), parameters);
      for (std::size_t i = 0; i < in.results.size(); ++i) mark(in.results[i], callee.results[i]);
      break;
    }
    case Op::array_store:
      if (active.values[in.operands[1]] && !active.arrays[array])
        active.arrays[array] = changed = true;
      break;
    case Op::array_load:
      mark(in.result(), active.arrays[array]);
      break;
    case Op::ffloor:
    case Op::fceil:
    case Op::ftrunc:
    case Op::fround:
      break;  // flat between their steps
    case Op::slope:
      break;  // nobody asks for the slopes of slopes
    default:
      for (const Value operand : in.operands)
        for (const Value result : in.results) mark(result, active.values[operand]);
      break;
  }
  return changed;
}

}  // namespace pse::passes
