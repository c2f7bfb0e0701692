// Copying heads, innermost loops first.
#include "antialias/rotate.h"

#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class Rotation {
 public:
  Rotation(Function& function, Decisions& decisions) : function_(function), decisions_(decisions) {}

  void walk(Region& region) {
    std::vector<Instruction> out;
    for (Instruction& in : region.body) {
      for (Region& inner : in.regions) walk(inner);
      if (in.op != Op::loop || !decides(in.regions[0])) {
        out.push_back(std::move(in));
        continue;
      }
      Region &head = in.regions[0], &body = in.regions[1];
      std::vector<Instruction> first = copy(head, body.params);
      std::vector<Instruction> last = copy(head, in.results);
      body.body.insert(body.body.begin(), std::make_move_iterator(first.begin()),
                       std::make_move_iterator(first.end()));
      out.push_back(std::move(in));
      out.insert(out.end(), std::make_move_iterator(last.begin()),
                 std::make_move_iterator(last.end()));
    }
    region.body = std::move(out);
  }

 private:
  bool is_jump(Value value) const {
    return value < decisions_.forks.size() && decisions_.forks[value];
  }

  bool decides(const Region& region) const {
    for (const Instruction& in : region.body) {
      if (in.results.size() == 1 && is_jump(in.result())) return true;
      for (const Region& inner : in.regions)
        if (decides(inner)) return true;
    }
    return false;
  }

  std::vector<Instruction> copy(const Region& head, const std::vector<Value>& values) {
    passes::Cloner cloner(function_);
    for (std::size_t i = 0; i < head.params.size(); ++i) cloner.set(head.params[i], values[i]);
    std::vector<Instruction> made;
    for (const Instruction& in : head.body) {
      made.push_back(cloner.clone(in));
      enter(in, cloner);
    }
    return made;
  }

  void enter(const Instruction& in, const passes::Cloner& cloner) {
    for (const Value value : in.results) {
      const Value to = cloner(value);
      if (to >= decisions_.forks.size()) {
        decisions_.forks.resize(to + 1);
        decisions_.bends.resize(to + 1);
      }
      decisions_.forks[to] = value < decisions_.forks.size() && decisions_.forks[value];
      decisions_.bends[to] = value < decisions_.bends.size() && decisions_.bends[value];
    }
    for (const Region& region : in.regions)
      for (const Instruction& inner : region.body) enter(inner, cloner);
  }

  Function& function_;
  Decisions& decisions_;
};

}  // namespace

void rotate_loops(Function& function, Decisions& decisions) {
  Rotation(function, decisions).walk(function.body);
}

}  // namespace pse::antialias
