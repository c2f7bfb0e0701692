// Which values a set of values is computed from, by a walk from uses to definitions. Control is
// left out: where it changes, there is a jump, and no slope.
#pragma once

#include <vector>

#include "ir/module.h"

namespace pse::passes {

class Slice {
 public:
  // Without calls, what functions are called with is left out.
  explicit Slice(const ir::Function& function, bool through_calls = true)
      : function_(function),
        needed_(function.values.size()),
        ends_(function.values.size()),
        arrays_(function.arrays.size()),
        through_calls_(through_calls) {}

  void need(ir::Value value) { needed_[value] = true; }
  // What this one is computed from is left out, unless something else needs it.
  void end_at(ir::Value value) { ends_[value] = true; }
  // Until nothing changes; a loop needs a round for each value that its turns hand on.
  void run();

  bool operator[](ir::Value value) const { return needed_[value]; }
  bool has_array(std::size_t array) const { return arrays_[array]; }

 private:
  void mark(ir::Value value);
  void walk(const ir::Region& region);
  void visit(const ir::Instruction& in);

  const ir::Function& function_;
  std::vector<bool> needed_;
  std::vector<bool> ends_;
  std::vector<bool> arrays_;
  bool through_calls_;
  bool changed_ = false;
};

}  // namespace pse::passes
