// The path is a sum of a random number for each outcome, so order does not matter between
// decisions; every turn of a loop multiplies what it adds to. All these numbers are 1 more than a
// multiple of 8, so paths also count: one step at one decision changes them by 1 modulo 8.
#include "antialias/path.h"

#include "passes/emit.h"
#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;
using passes::Emit;

class Paths {
 public:
  Paths(Function& function, const Decisions& decisions)
      : function_(function), decisions_(decisions) {}

  // The path at the end of the region, given that at its beginning.
  Value walk(Region& region, Value path) {
    std::vector<Instruction> out;
    out.reserve(region.body.size() * 2);
    for (Instruction& in : region.body) {
      if (in.op == Op::if_) {
        path = branch(in, path);
        out.push_back(std::move(in));
      } else if (in.op == Op::loop) {
        path = turn(in, path);
        out.push_back(std::move(in));
      } else {
        const bool jumps = in.results.size() == 1 && in.result() < decisions_.forks.size() &&
                           decisions_.forks[in.result()];
        out.push_back(std::move(in));
        if (jumps) path = outcome(Emit(function_, out), Instruction(out.back()), path);
      }
    }
    region.body = std::move(out);
    return path;
  }

 private:
  // A random number, 1 modulo 8.
  std::int32_t next_factor() {
    state_ += 0x9e3779b9u;
    std::uint32_t h = state_;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return static_cast<std::int32_t>(((h ^ (h >> 16)) & ~7u) | 1u);
  }

  Value outcome(const Emit& emit, const Instruction& in, Value path) {
    const Value factor = emit.integer(next_factor());
    const Cut cut = cut_of(in.op);
    if (cut == Cut::compare || cut == Cut::kink) {
      const Value is_first =
          cut == Cut::compare ? in.result() : emit.less(in.operands[0], in.operands[1]);
      return emit(Op::iadd, {path, emit.choose(is_first, factor, emit.integer(0))});
    }
    const Value whole = in.op == Op::f2i ? in.result() : emit(Op::f2i, {in.result()});
    return emit(Op::iadd, {path, emit(Op::imul, {whole, factor})});
  }

  Value branch(Instruction& in, Value path) {
    if (decisions_.is_dither(in)) return path;
    const Value yes = walk(in.regions[0], path), no = walk(in.regions[1], path);
    if (yes == path && no == path) return path;
    in.regions[0].yields.push_back(yes);
    in.regions[1].yields.push_back(no);
    in.results.push_back(function_.add_value(ir::Type::i32));
    return in.results.back();
  }

  Value turn(Instruction& in, Value path) {
    if (decisions_.is_dither(in)) return path;
    Region &head = in.regions[0], &body = in.regions[1];
    head.params.push_back(function_.add_value(ir::Type::i32));
    body.params.push_back(function_.add_value(ir::Type::i32));
    const Value within = body.params.back();
    const Value after = walk(body, within);
    const Value condition = head.yields[0];
    if (after == within && function_.values[condition].rate != ir::Rate::sample) {
      head.params.pop_back();
      body.params.pop_back();
      return path;
    }
    const Emit emit(function_, body.body);
    const Value mixed = emit(Op::imul, {after, emit.integer(next_factor())});
    body.yields.push_back(emit(Op::iadd, {mixed, emit.integer(next_factor())}));
    in.operands.push_back(path);
    in.results.push_back(function_.add_value(ir::Type::i32));
    return in.results.back();
  }

  Function& function_;
  const Decisions& decisions_;
  std::uint32_t state_ = 1;
};

void remove_checks(Region& region) {
  std::erase_if(region.body, [](const Instruction& in) { return in.op == Op::check; });
  for (Instruction& in : region.body)
    for (Region& inner : in.regions) remove_checks(inner);
}

bool has_checks(const Region& region) {
  for (const Instruction& in : region.body) {
    if (in.op == Op::check) return true;
    for (const Region& inner : in.regions)
      if (has_checks(inner)) return true;
  }
  return false;
}

}  // namespace

bool has_checks(const ir::Module& module) {
  for (const Function& function : module.functions)
    if (has_checks(function.body)) return true;
  return false;
}

void add_path(ir::Module& module, const Decisions& decisions) {
  Function& main = module.main();
  std::vector<Instruction> start;
  const Value none = Emit(main, start).integer(0);
  const Value path = Paths(main, decisions).walk(main.body, none);
  main.body.body.insert(main.body.body.begin(), std::move(start.front()));
  const Emit emit(main, main.body.body);
  // Floats hold whole numbers of 24 bits exactly.
  const Value high = emit(Op::ishl, {path, emit.integer(8)});
  const Value low = emit(Op::ishr, {high, emit.integer(8)});
  main.body.yields.push_back(emit(Op::i2f, {low}));
  module.outputs.push_back({path_name});
}

void remove_checks(ir::Module& module) {
  for (Function& function : module.functions) remove_checks(function.body);
}

}  // namespace pse::antialias
