// Constant folding and exact algebra, in one walk in order of definition. The rules are in
// fold_*.cpp.
#include <utility>

#include "passes/constant_calls.h"
#include "passes/folder.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

using ir::Bits;
using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class FoldWalk {
 public:
  FoldWalk(ir::Module& module, Function& function, ConstantCalls& calls)
      : module_(module),
        function_(function),
        calls_(calls),
        folder_(module, function),
        renaming_(function.values.size()) {}

  void run() { walk(function_.body); }

 private:
  void walk(Region& region) {
    std::vector<Instruction> out;
    out.reserve(region.body.size());
    walk(region, out);
    region.body = std::move(out);
    renaming_.apply(region.yields);
  }

  // Appends what becomes of the region's instructions to `out`.
  void walk(Region& region, std::vector<Instruction>& out) {
    for (Instruction& in : region.body) {
      renaming_.apply(in.operands);
      switch (in.op) {
        case Op::check:
          fold_check(in, out);
          break;
        case Op::call:
          fold_call(in, out);
          break;
        case Op::if_:
          fold_if(in, out);
          break;
        case Op::loop:
          walk(in.regions[0]);
          walk(in.regions[1]);
          out.push_back(std::move(in));
          break;
        default:
          fold_plain(in, out);
          break;
      }
    }
  }

  void fold_plain(Instruction& in, std::vector<Instruction>& out) {
    const Folded folded = folder_.simplify(in, out);
    if (folded.replaced()) return renaming_.set(in.result(), folded.value);
    folder_.note(in);
    out.push_back(std::move(in));
  }

  void fold_check(Instruction& in, std::vector<Instruction>& out) {
    if (folder_.constant(in.operands[0]) != Bits{1}) out.push_back(std::move(in));
  }

  void fold_call(Instruction& in, std::vector<Instruction>& out) {
    std::vector<Bits> arguments;
    for (const Value operand : in.operands) {
      const auto bits = folder_.constant(operand);
      if (!bits) return out.push_back(std::move(in));
      arguments.push_back(*bits);
    }
    const auto results = calls_.run(static_cast<std::uint32_t>(in.imm), arguments);
    if (!results) return out.push_back(std::move(in));
    for (std::size_t i = 0; i < in.results.size(); ++i)
      add_constant(in.results[i], (*results)[i], in.span, out);
  }

  // Defines `value` as a constant.
  void add_constant(Value value, Bits bits, const Span& span, std::vector<Instruction>& out) {
    const ir::Type type = function_.values[value].type;
    const Op op = type == ir::Type::f32   ? Op::const_f32
                  : type == ir::Type::i32 ? Op::const_i32
                                          : Op::const_bool;
    if (type == ir::Type::f32) bits = ir::canonical(bits);
    Instruction in{
        .op = op, .results = {value}, .imm = static_cast<std::int32_t>(bits), .span = span};
    folder_.note(in);
    out.push_back(std::move(in));
  }

  void fold_if(Instruction& in, std::vector<Instruction>& out) {
    const Value condition = in.operands[0];
    if (const auto known = folder_.constant(condition)) {
      // Only one side is left, in the place of the if.
      Region& side = in.regions[*known ? 0 : 1];
      walk(side, out);
      renaming_.apply(side.yields);
      for (std::size_t i = 0; i < in.results.size(); ++i)
        renaming_.set(in.results[i], side.yields[i]);
      return;
    }
    assume(condition, true, in.regions[0]);
    assume(condition, false, in.regions[1]);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      const Value yes = in.regions[0].yields[i], no = in.regions[1].yields[i];
      const auto first = folder_.constant(yes), second = folder_.constant(no);
      if (yes == no) {
        renaming_.set(in.results[i], yes);
      } else if (first && first == second) {
        const Value same = function_.add_value(function_.values[in.results[i]].type);
        add_constant(same, *first, in.span, out);
        renaming_.set(in.results[i], same);
      } else if (folder_.type(yes) == ir::Type::boolean && first == Bits{1} && second == Bits{0}) {
        renaming_.set(in.results[i], condition);
      }
    }
    out.push_back(std::move(in));
  }

  // Walks a side of an if knowing its condition, and what that says of the condition's own parts.
  void assume(Value condition, bool holds, Region& side) {
    std::vector<std::pair<Value, std::int8_t>> before;
    const auto set = [&](Value value, bool truth) {
      before.emplace_back(value, folder_.known(value).assumed);
      folder_.known(value).assumed = truth;
    };
    set(condition, holds);
    const Known from = folder_.known(condition);
    if (from.op == Op::bnot) set(from.operands[0], !holds);
    if ((from.op == Op::band && holds) || (from.op == Op::bor && !holds)) {
      set(from.operands[0], holds);
      set(from.operands[1], holds);
    }
    walk(side);
    for (auto entry = before.rbegin(); entry != before.rend(); ++entry) {
      folder_.known(entry->first).assumed = entry->second;
    }
  }

  ir::Module& module_;
  Function& function_;
  ConstantCalls& calls_;
  Folder folder_;
  Renaming renaming_;
};

}  // namespace

void fold(ir::Module& module) {
  ConstantCalls calls(module);
  for (Function& function : module.functions) FoldWalk(module, function, calls).run();
}

}  // namespace pse::passes
