// A condition laid open where a function hides it.
#include "antialias/seams.h"

#include <unordered_map>

#include "passes/emit.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Value;
using passes::Emit;

class Seams {
 public:
  explicit Seams(ir::Module& module) : module_(module) {}

  void walk(ir::Region& region) {
    std::vector<Instruction> out;
    for (Instruction& in : region.body) {
      for (ir::Region& inner : in.regions) walk(inner);
      if (in.op == Op::fabs) size_of_[in.result()] = in.operands[0];
      out.push_back(std::move(in));
      const Instruction written = out.back();
      const Emit emit(module_.main(), out);
      if (is_call_of(written, "atan2")) {
        // Above 0 wherever it is continuous, and below as soon as the angle is: at -0 too.
        const Value is_behind = emit.less(written.operands[1], emit.number(0));
        const Value is_below = emit.less(written.result(), emit.number(0));
        const Value at = emit.choose(is_below, emit.number(-1e-37f), emit.number(0));
        see(emit, emit.choose(is_behind, emit.add(written.operands[0], at), emit.number(1)));
      } else if (written.op == Op::fdiv) {
        if (const auto by = size_of_.find(written.operands[1]); by != size_of_.end())
          see(emit, by->second);
      }
    }
    region.body = std::move(out);
  }

  std::vector<Value> found() && { return std::move(found_); }

 private:
  bool is_call_of(const Instruction& in, const char* name) const {
    return in.op == Op::call && module_.functions[static_cast<std::size_t>(in.imm)].name == name;
  }
  void see(const Emit& emit, Value value) { found_.push_back(emit.less(value, emit.number(0))); }

  ir::Module& module_;
  std::unordered_map<Value, Value> size_of_;  // what an absolute value is of
  std::vector<Value> found_;
};

}  // namespace

std::vector<Value> add_seams(ir::Module& module) {
  Seams seams(module);
  seams.walk(module.main().body);
  return std::move(seams).found();
}

}  // namespace pse::antialias
