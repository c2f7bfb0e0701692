// From definitions to uses until nothing changes; loops need a round for each value handed on.
#include "bounds/dependence.h"

#include <algorithm>

namespace pse::bounds {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class Walk {
 public:
  explicit Walk(const ir::Module& module) : module_(module) {
    found_.values.resize(module.main().values.size());
    found_.arrays.resize(module.main().arrays.size());
  }

  Dependence run() {
    do {
      changed_ = false;
      walk(module_.main().body, false);
    } while (changed_);
    return std::move(found_);
  }

 private:
  bool at(Value value) const { return found_.values[value]; }
  void mark(std::vector<bool>& list, std::size_t i, bool depends) {
    if (!depends || list[i]) return;
    list[i] = changed_ = true;
  }

  // `undecided`: whether it runs depends on the place.
  void walk(const Region& region, bool undecided) {
    for (const Instruction& in : region.body) {
      const bool condition = undecided || (in.op == Op::if_ && at(in.operands[0])) ||
                             (in.op == Op::loop && at(in.regions[0].yields[0]));
      for (const Region& inner : in.regions) walk(inner, condition);
      visit(in, undecided);
    }
  }

  void visit(const Instruction& in, bool undecided) {
    const auto set = [&](Value value, bool depends) { mark(found_.values, value, depends); };
    const auto array = static_cast<std::size_t>(in.imm);
    const bool any = std::ranges::any_of(in.operands, [&](Value v) { return at(v); });
    switch (in.op) {
      case Op::input:
        set(in.result(), module_.inputs[array].rate == ir::Rate::sample);
        break;
      case Op::if_:
        for (std::size_t i = 0; i < in.results.size(); ++i)
          set(in.results[i],
              at(in.operands[0]) || at(in.regions[0].yields[i]) || at(in.regions[1].yields[i]));
        break;
      case Op::loop: {
        const bool ends_anywhere = at(in.regions[0].yields[0]);
        for (std::size_t i = 0; i < in.results.size(); ++i) {
          const bool carried = at(in.operands[i]) || at(in.regions[1].yields[i]);
          for (const Region& region : in.regions) set(region.params[i], carried);
          set(in.results[i], carried || ends_anywhere);
        }
        break;
      }
      case Op::array_store:
      case Op::array_resize:
        mark(found_.arrays, array, any || undecided);
        break;
      case Op::array_load:
      case Op::array_length:
        set(in.result(), any || found_.arrays[array]);
        break;
      default:
        for (const Value result : in.results) set(result, any);
    }
  }

  const ir::Module& module_;
  Dependence found_;
  bool changed_ = false;
};

}  // namespace

Dependence find_dependence(const ir::Module& module) { return Walk(module).run(); }

}  // namespace pse::bounds
