// Moves instructions to regions further out, in one walk: the engine of hoist.cpp and
// hoist_frame.cpp.
#pragma once

#include <functional>
#include <vector>

#include "ir/module.h"
#include "passes/rewrite.h"

namespace pse::passes {

// One region on the way from the function's body (depth 0) to an instruction.
struct HoistRegion {
  bool is_loop = false;                // head or body of a loop
  ir::Value condition = ir::no_value;  // of the if, or that the loop's head yields
};

struct HoistPlace {
  const std::vector<HoistRegion>& path;
  std::size_t operand_depth;  // the deepest region that an operand is defined in
};

class Hoister {
 public:
  // Gives the depth to move to: from operand_depth up to path.size() - 1, which means staying.
  using Choose = std::function<std::size_t(const HoistPlace&)>;
  using MayMove = std::function<bool(const ir::Instruction&)>;

  Hoister(ir::Function& function, Choose choose)
      : function_(function), choose_(std::move(choose)), depth_(function.values.size(), 0) {}

  void run(const MayMove& may_move) {
    may_move_ = &may_move;
    path_.push_back({});
    walk(function_.body);
    path_.pop_back();
  }

 private:
  void walk(ir::Region& region) {
    const std::size_t here = path_.size() - 1;
    for (const ir::Value param : region.params) depth_[param] = here;
    std::vector<ir::Instruction> body = std::move(region.body);
    region.body.clear();
    region.body.reserve(body.size());
    regions_.push_back(&region);
    for (ir::Instruction& in : body) {
      for (std::size_t i = 0; i < in.regions.size(); ++i) walk_inner(in, in.regions[i]);
      const std::size_t to =
          here > 0 && (*may_move_)(in) ? choose_({path_, operand_depth(in)}) : here;
      for (const ir::Value result : in.results) depth_[result] = to;
      regions_[to]->body.push_back(std::move(in));
    }
    regions_.pop_back();
  }

  void walk_inner(const ir::Instruction& in, ir::Region& region) {
    const bool is_loop = in.op == ir::Op::loop;
    path_.push_back({is_loop, is_loop ? in.regions[0].yields[0] : in.operands[0]});
    walk(region);
    path_.pop_back();
  }

  // Of an instruction with regions, what its regions use counts too; such are moved only by
  // hoist_frame, which asks.
  std::size_t operand_depth(const ir::Instruction& in) const {
    std::size_t deepest = 0;
    for (const ir::Value operand : in.operands) deepest = std::max(deepest, depth_[operand]);
    return deepest;
  }

  ir::Function& function_;
  Choose choose_;
  const MayMove* may_move_ = nullptr;
  std::vector<std::size_t> depth_;  // per value: the depth of the region that it is defined in
  std::vector<HoistRegion> path_;
  std::vector<ir::Region*> regions_;  // those being refilled, by depth
};

}  // namespace pse::passes
