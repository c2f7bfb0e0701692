// Loop-invariant code: cheap pure instructions move in front of the outermost loop that they do not
// depend on, also out of ifs on the way, since nothing traps. Calls, ifs and loops stay: they may
// be dear, and may never have run.
#include <utility>

#include "passes/hoister.h"
#include "passes/passes.h"

namespace pse::passes {

void hoist(ir::Module& module) {
  for (ir::Function& function : module.functions) {
    Hoister hoister(function, [](const HoistPlace& place) {
      // The outermost loop between the operands and the instruction decides.
      for (std::size_t depth = place.operand_depth + 1; depth < place.path.size(); ++depth) {
        if (place.path[depth].is_loop) return depth - 1;
      }
      return place.path.size() - 1;
    });
    hoister.run([](const ir::Instruction& in) { return is_cheap_and_pure(in.op); });
  }
}

}  // namespace pse::passes
