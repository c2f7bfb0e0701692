// Small tools that passes share: renaming values, and what may be moved or computed in vain.
#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include "ir/module.h"

namespace pse::passes {

// Replaces values by others while a function is walked in order of definition.
class Renaming {
 public:
  explicit Renaming(std::size_t values) : to_(values, ir::no_value) {}
  ir::Value operator()(ir::Value value) const {
    return value < to_.size() && to_[value] != ir::no_value ? to_[value] : value;
  }
  void apply(std::vector<ir::Value>& values) const {
    for (ir::Value& value : values) value = (*this)(value);
  }
  // `to` must be final: not itself replaced.
  void set(ir::Value from, ir::Value to) {
    if (from >= to_.size()) to_.resize(from + 1, ir::no_value);
    to_[from] = to;
  }

 private:
  std::vector<ir::Value> to_;
};

// Copies instructions with fresh values for what they define. What they use and was not defined by
// them or set stays.
class Cloner {
 public:
  explicit Cloner(ir::Function& function) : function_(function) {}

  void set(ir::Value from, ir::Value to) { fresh_[from] = to; }
  ir::Value operator()(ir::Value value) const {
    const auto found = fresh_.find(value);
    return found == fresh_.end() ? value : found->second;
  }

  ir::Instruction clone(const ir::Instruction& in) {
    ir::Instruction made{.op = in.op,
                         .operands = used(in.operands),
                         .imm = in.imm,
                         .component = in.component,
                         .span = in.span};
    for (const ir::Region& region : in.regions) {
      ir::Region inner{.params = defined(region.params)};
      for (const ir::Instruction& nested : region.body) inner.body.push_back(clone(nested));
      inner.yields = used(region.yields);
      made.regions.push_back(std::move(inner));
    }
    made.results = defined(in.results);
    return made;
  }

 private:
  std::vector<ir::Value> used(const std::vector<ir::Value>& values) const {
    std::vector<ir::Value> made;
    for (const ir::Value value : values) made.push_back((*this)(value));
    return made;
  }
  std::vector<ir::Value> defined(const std::vector<ir::Value>& values) {
    std::vector<ir::Value> made;
    for (const ir::Value value : values) {
      function_.values.push_back(function_.values[value]);
      made.push_back(static_cast<ir::Value>(function_.values.size() - 1));
      fresh_[value] = made.back();
    }
    return made;
  }

  ir::Function& function_;
  std::unordered_map<ir::Value, ir::Value> fresh_;
};

inline bool is_constant(ir::Op op) {
  return op == ir::Op::const_f32 || op == ir::Op::const_i32 || op == ir::Op::const_bool;
}
inline bool is_call(ir::Op op) { return op == ir::Op::call || op == ir::Op::external; }
inline bool reads_array(ir::Op op) {
  return op == ir::Op::array_load || op == ir::Op::array_length;
}
inline bool writes_array(ir::Op op) {
  return op == ir::Op::array_store || op == ir::Op::array_resize;
}
// Ends the run or tells the host of something: it stays although nobody uses a result.
inline bool is_effect(const ir::Instruction& in) {
  return in.op == ir::Op::check || (in.op == ir::Op::external && in.results.empty());
}
inline bool has_regions(ir::Op op) { return op == ir::Op::if_ || op == ir::Op::loop; }
// May be computed where its result is not needed, at little cost: nothing traps.
inline bool is_cheap_and_pure(ir::Op op) { return ir::info(op).pure && !is_call(op); }

// Roughly how long an instruction without regions takes, in additions.
inline int cost_of(ir::Op op) {
  switch (op) {
    case ir::Op::const_f32:
    case ir::Op::const_i32:
    case ir::Op::const_bool:
    case ir::Op::input:
      return 0;
    case ir::Op::fdiv:
    case ir::Op::fsqrt:
    case ir::Op::array_load:
    case ir::Op::table_f32:
    case ir::Op::table_i32:
    case ir::Op::bytes_lookup:
      return 4;
    case ir::Op::call:
    case ir::Op::external:
      return 1000;
    default:
      return 1;
  }
}

}  // namespace pse::passes
