// Walks over regions that count. See the header.
#include "ir/count.h"

#include <algorithm>

namespace pse::ir {
namespace {

Rate rate_of(const Function& function, const std::vector<Value>& values) {
  Rate rate = Rate::constant;
  for (const Value value : values) rate = std::max(rate, function.values[value].rate);
  return rate;
}

void count_by_rate(const Function& function, const Region& region, RateCounts& counts) {
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) count_by_rate(function, inner, counts);
    if (in.op <= Op::input) continue;
    ++counts[static_cast<std::size_t>(
        rate_of(function, in.results.empty() ? in.operands : in.results))];
  }
}

}  // namespace

std::size_t count_instructions(const Region& region) {
  std::size_t count = region.body.size();
  for (const Instruction& in : region.body) {
    for (const Region& inner : in.regions) count += count_instructions(inner);
  }
  return count;
}

std::size_t count_instructions(const Function& function) {
  return count_instructions(function.body);
}

std::size_t count_instructions(const Module& module) {
  std::size_t count = 0;
  for (const Function& function : module.functions) count += count_instructions(function);
  return count;
}

std::size_t count_instructions(const Region& region, Op op) {
  std::size_t count = 0;
  for (const Instruction& in : region.body) {
    if (in.op == op) ++count;
    for (const Region& inner : in.regions) count += count_instructions(inner, op);
  }
  return count;
}

RateCounts count_by_rate(const Function& function) {
  RateCounts counts{};
  count_by_rate(function, function.body, counts);
  return counts;
}

}  // namespace pse::ir
