// One walk over the function, in the order of the code.
#include "codegen/first/lifetimes.h"

#include <algorithm>

namespace pse::first {
namespace {

class Walk {
 public:
  Walk(const ir::Function& function, std::vector<std::int32_t>& last_use)
      : last_use_(last_use), depth_(function.values.size()) {}

  void region(const ir::Region& region) {
    for (const ir::Value param : region.params) define(param);
    for (const ir::Instruction& in : region.body) instruction(in);
    const std::int32_t step = step_++;
    for (const ir::Value value : region.yields) use(value, step);
  }

 private:
  void define(ir::Value value) {
    depth_[value] = static_cast<std::int32_t>(loops_.size());
    last_use_[value] = std::max(last_use_[value], 2 * step_ - 1);
  }

  // A value from outside of a loop is needed until its last turn.
  void use(ir::Value value, std::int32_t step) {
    last_use_[value] = std::max(last_use_[value], 2 * step);
    const auto depth = static_cast<std::size_t>(depth_[value]);
    if (depth < loops_.size()) loops_[depth].push_back(value);
  }

  void instruction(const ir::Instruction& in) {
    const std::int32_t step = step_++;
    for (const ir::Value operand : in.operands) use(operand, step);
    if (in.op == ir::Op::loop) {
      loops_.emplace_back();
      for (const ir::Region& inner : in.regions) region(inner);
      for (const ir::Value value : loops_.back())
        last_use_[value] = std::max(last_use_[value], 2 * (step_ - 1) + 1);
      loops_.pop_back();
    } else {
      for (const ir::Region& inner : in.regions) region(inner);
    }
    for (const ir::Value result : in.results) define(result);
  }

  std::vector<std::int32_t>& last_use_;
  std::vector<std::int32_t> depth_;            // per value: loops around its definition
  std::vector<std::vector<ir::Value>> loops_;  // those around: the outer values they use
  std::int32_t step_ = 0;
};

}  // namespace

Lifetimes::Lifetimes(const ir::Function& function) : last_use(function.values.size(), -1) {
  Walk(function, last_use).region(function.body);
  order.resize(last_use.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<ir::Value>(i);
  std::ranges::stable_sort(order, {}, [this](ir::Value value) { return last_use[value]; });
}

}  // namespace pse::first
