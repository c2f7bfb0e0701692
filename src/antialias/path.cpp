// The path is a sum of a random number for each outcome, so order does not matter between
// decisions; every turn of a loop multiplies what it adds to. All these numbers are 1 more than a
// multiple of 8, so paths also count: one step at one decision changes them by 1 modulo 8.
//
// A loop that searches, a ray's march above all, turns differently often at every pixel and yet
// ends in the same place: its turns are no ways of their own. Its last turn tells what it has met,
// and what it ends with jumps where it meets something else. (The 2002 chapter has no loops.)
#include "antialias/path.h"

#include <algorithm>
#include <array>

#include "passes/emit.h"
#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Region;
using ir::Value;
using passes::Emit;

// What is carried along through the program.
struct Way {
  Value way;    // the outcomes so far; of searching loops those of the last turn
  Value turns;  // all turns of searching loops
  Value ends;   // the sum of what these ended with; no_value inside of them
};

bool stores(const Region& region) {
  for (const Instruction& in : region.body) {
    if (passes::writes_array(in.op)) return true;
    for (const Region& inner : in.regions)
      if (stores(inner)) return true;
  }
  return false;
}

// Whether a turn makes `before` into `after` by adding a step to it, or leaves it: a count of turns.
bool counts(const Function& function, const Region& body, Value after, Value before) {
  if (after == before) return true;
  for (const Instruction& in : body.body) {
    const auto at = std::ranges::find(in.results, after);
    if (at == in.results.end()) continue;
    if (in.op == Op::fadd || in.op == Op::iadd)
      return (in.operands[0] == before && function.values[in.operands[1]].rate != ir::Rate::sample) ||
             (in.operands[1] == before && function.values[in.operands[0]].rate != ir::Rate::sample);
    if (in.op != Op::if_) return false;
    const auto k = static_cast<std::size_t>(at - in.results.begin());
    return std::ranges::all_of(in.regions, [&](const Region& region) {
      return counts(function, region, region.yields[k], before);
    });
  }
  return false;
}

void find_uses(const Region& region, std::vector<bool>& used) {
  const auto use = [&](const std::vector<Value>& values) {
    for (const Value value : values) used[value] = true;
  };
  for (const Instruction& in : region.body) {
    use(in.operands);
    for (const Region& inner : in.regions) find_uses(inner, used);
  }
  use(region.yields);
}

class Paths {
 public:
  Paths(Function& function, const Decisions& decisions)
      : function_(function), decisions_(decisions), used_(function.values.size()) {
    find_uses(function.body, used_);
  }

  bool has_searches() const { return has_searches_; }

  // What is carried at the end of the region, given that at its beginning.
  Way walk(Region& region, Way way) {
    std::vector<Instruction> out;
    out.reserve(region.body.size() * 2);
    for (Instruction& in : region.body) {
      if (in.op == Op::if_) {
        way = branch(in, way);
        out.push_back(std::move(in));
      } else if (in.op == Op::loop) {
        const bool searches = is_search(in);
        way = searches ? search(in, way) : turn(in, way);
        out.push_back(std::move(in));
        if (searches && way.ends != no_value)
          way.ends = with_ends(Emit(function_, out), Instruction(out.back()), way.ends);
      } else {
        const bool jumps = in.results.size() == 1 && in.result() < decisions_.forks.size() &&
                           decisions_.forks[in.result()];
        out.push_back(std::move(in));
        if (jumps) way.way = outcome(Emit(function_, out), Instruction(out.back()), way.way);
      }
    }
    region.body = std::move(out);
    return way;
  }

 private:
  // Bends leave the lower bits.
  static constexpr int bend_bits = 10;
  static constexpr std::array parts = {&Way::way, &Way::turns, &Way::ends};

  // A random number, 1 modulo 8.
  std::int32_t next_factor() {
    state_ += 0x9e3779b9u;
    std::uint32_t h = state_;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return static_cast<std::int32_t>(((h ^ (h >> 16)) & ~7u) | 1u);
  }

  Value outcome(const Emit& emit, const Instruction& in, Value path) {
    const Cut cut = cut_of(in.op);
    const std::int32_t number = next_factor();
    const Value factor = emit.integer(cut == Cut::kink ? number << bend_bits : number);
    if (cut == Cut::compare || cut == Cut::kink) {
      const Value is_first =
          cut == Cut::compare ? in.result() : emit.less(in.operands[0], in.operands[1]);
      return emit(Op::iadd, {path, emit.choose(is_first, factor, emit.integer(0))});
    }
    const Value whole = in.op == Op::f2i ? in.result() : emit(Op::f2i, {in.result()});
    return emit(Op::iadd, {path, emit(Op::imul, {whole, factor})});
  }

  Way branch(Instruction& in, Way before) {
    if (decisions_.is_dither(in)) return before;
    const Way yes = walk(in.regions[0], before), no = walk(in.regions[1], before);
    Way after = before;
    for (const auto part : parts) {
      if (yes.*part == before.*part && no.*part == before.*part) continue;
      in.regions[0].yields.push_back(yes.*part);
      in.regions[1].yields.push_back(no.*part);
      in.results.push_back(function_.add_value(function_.values[yes.*part].type));
      after.*part = in.results.back();
    }
    return after;
  }

  // One more value that a loop's turns hand on: what it is in the body.
  Value carry(Instruction& in, ir::Type type) {
    in.regions[0].params.push_back(function_.add_value(type));
    in.regions[1].params.push_back(function_.add_value(type));
    return in.regions[1].params.back();
  }
  Value finish(Instruction& in, Value before, Value after) {
    in.operands.push_back(before);
    in.regions[1].yields.push_back(after);
    in.results.push_back(function_.add_value(function_.values[before].type));
    return in.results.back();
  }

  // A loop that turns equally often everywhere, or one of whose turns any may be seen.
  Way turn(Instruction& in, Way before) {
    if (decisions_.is_dither(in)) return before;
    Region& body = in.regions[1];
    const std::size_t own = body.params.size();
    Way within = before;
    for (const auto part : parts)
      if (before.*part != no_value)
        within.*part = carry(in, function_.values[before.*part].type);
    const Way after = walk(body, within);
    const bool differs = function_.values[in.regions[0].yields[0]].rate == ir::Rate::sample;
    Way result = before;
    std::size_t k = own;
    for (const auto part : parts) {
      if (before.*part == no_value) continue;
      const bool is_way = part == &Way::way;
      if (after.*part == within.*part && !(is_way && differs)) {
        for (Region& region : in.regions)
          region.params.erase(region.params.begin() + static_cast<std::ptrdiff_t>(k));
        continue;
      }
      const Emit emit(function_, body.body);
      Value next = after.*part;
      if (is_way) {
        const Value mixed = emit(Op::imul, {next, emit.integer(next_factor())});
        next = emit(Op::iadd, {mixed, emit.integer(next_factor())});
      } else if (part == &Way::turns) {
        next = emit(Op::imul, {next, emit.integer(next_factor())});
      }
      result.*part = finish(in, before.*part, next);
      ++k;
    }
    return result;
  }

  bool is_search(const Instruction& in) const {
    return !decisions_.is_dither(in) &&
           function_.values[in.regions[0].yields[0]].rate == ir::Rate::sample &&
           !stores(in.regions[0]) && !stores(in.regions[1]);
  }

  // Every turn's way begins anew.
  Way search(Instruction& in, Way before) {
    has_searches_ = true;
    Region& body = in.regions[1];
    const Value turns = carry(in, ir::Type::i32);
    const Way after = walk(body, {before.way, turns, no_value});
    const Emit emit(function_, body.body);
    const Value of_turn = emit(Op::isub, {after.way, before.way});
    const Value mixed = emit(Op::imul, {after.turns, emit.integer(next_factor())});
    const Value sum = emit(Op::iadd, {mixed, of_turn});
    Way result = before;
    result.turns =
        finish(in, before.turns, emit(Op::iadd, {sum, emit.integer(next_factor())}));
    if (after.way != before.way) {
      carry(in, ir::Type::i32);
      result.way = finish(in, before.way, after.way);
    }
    return result;
  }

  // The sum with what a search ends with and is used.
  Value with_ends(const Emit& emit, const Instruction& search, Value sum) {
    const Region& body = search.regions[1];
    for (std::size_t k = 0; k < search.results.size(); ++k) {
      const Value end = search.results[k];
      if (end >= used_.size() || !used_[end]) continue;
      const ir::Type type = function_.values[end].type;
      // 1 to 2, so that no two ends make up for each other.
      const float weight = 1 + static_cast<float>(next_factor() & 0xfff0) * 0x1p-16f;
      if (type == ir::Type::boolean) {
        const Value one = emit.number(weight);
        sum = emit.add(sum, emit.choose(end, one, emit.number(0)));
        continue;
      }
      const Value value = type == ir::Type::i32 ? emit(Op::i2f, {end}) : end;
      const bool is_count = counts(function_, body, body.yields[k], body.params[k]);
      const Value seen = is_count ? value : size(emit, value);
      sum = emit(Op::fma, {seen, emit.number(weight), sum});
    }
    return sum;
  }

  // The logarithm to base 2 of 1 + |v|, nearly, with the sign of v; finite.
  static Value size(const Emit& emit, Value v) {
    const Value above = emit.add(emit(Op::fabs, {v}), emit.number(1));
    const Value steps = emit(Op::isub, {emit(Op::f2bits, {above}), emit.integer(0x3f800000)});
    const Value size = emit.mul(emit(Op::i2f, {steps}), emit.number(0x1p-23f));
    return emit.choose(emit.less(v, emit.number(0)), emit(Op::fneg, {size}), size);
  }

  Function& function_;
  const Decisions& decisions_;
  std::vector<bool> used_;
  bool has_searches_ = false;
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

std::size_t add_path(ir::Module& module, const Decisions& decisions) {
  Function& main = module.main();
  std::vector<Instruction> start;
  const Emit first(main, start);
  const Way none{first.integer(0), first.integer(0), first.number(0)};
  Paths paths(main, decisions);
  const Way way = paths.walk(main.body, none);
  main.body.body.insert(main.body.body.begin(), std::make_move_iterator(start.begin()),
                        std::make_move_iterator(start.end()));
  const Emit emit(main, main.body.body);
  const auto give = [&](const char* name, Value value) {
    main.body.yields.push_back(value);
    module.outputs.push_back({name});
  };
  // Floats hold whole numbers of 24 bits exactly.
  const auto whole = [&](Value path) {
    const Value high = emit(Op::ishl, {path, emit.integer(8)});
    return emit(Op::i2f, {emit(Op::ishr, {high, emit.integer(8)})});
  };
  const std::size_t own = module.outputs.size();
  if (!paths.has_searches()) {
    give(path_name, whole(way.way));
  } else {
    give(path_name, whole(emit(Op::iadd, {way.way, way.turns})));
    give(way_name, whole(way.way));
    give(ends_name, way.ends);
  }
  return module.outputs.size() - own;
}

void remove_checks(ir::Module& module) {
  for (Function& function : module.functions) remove_checks(function.body);
}

}  // namespace pse::antialias
