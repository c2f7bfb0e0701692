// The path is a sum of a random number for each outcome, so order does not matter between
// decisions; every turn of a loop multiplies what it adds to. Numbers of jumps are 1 more than a
// multiple of 8, so paths also count: one step at one jump changes them by 1 modulo 8. The next
// three bits count those of creases, and numbers of bends leave the lower bits as they are.
//
// A loop that searches, a ray's march above all, turns differently often at every pixel and yet
// ends in the same place: its turns are no ways of their own. Its last turn tells what it has met,
// and what it ends with jumps where it meets something else. (The 2002 chapter has no loops.) A
// last turn that changes nothing has met nothing: so it does not matter where a prepass ends a
// march.
#include "antialias/path.h"

#include <array>
#include <span>

#include "antialias/bent.h"
#include "antialias/fine.h"
#include "ir/expectations.h"
#include "passes/emit.h"

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
  Value path;
  Value ends;  // the sum of what searches ended with and rays met; no_value inside of searches
  Value fine;  // the farthest move of noise; likewise, and where there is none
  Value bent;  // not 0: a jump that may be unseen is near; likewise
};

class Paths {
 public:
  Paths(ir::Module& module, const Decisions& decisions, float reach)
      : module_(module),
        function_(module.main()),
        decisions_(decisions),
        roots_(module),
        bounds_(module, decisions),
        reach_(reach) {}

  bool has_searches() const { return has_searches_; }

  // What is carried at the end of the region, given that at its beginning.
  Way walk(Region& region, Way way) {
    std::vector<Instruction> out;
    out.reserve(region.body.size() * 2);
    for (Instruction& in : region.body) {
      const bool searches = decisions_.is_search(in);
      if (in.op == Op::if_)
        way = branch(in, way);
      else if (searches)
        way.path = search(in, way.path);
      else if (in.op == Op::loop)
        way = turn(in, way);
      const std::size_t at = out.size();
      out.push_back(std::move(in));
      const Instruction& written = out.back();
      const bool jumps =
          written.results.size() == 1 && written.result() < decisions_.forks.size() &&
          (decisions_.forks[written.result()] || is_fold(written.op, written.result()));
      if (searches && way.ends != no_value)
        way.ends = with_ends(Emit(function_, out), std::vector(written.results), way.ends);
      else if (jumps)
        way.path = outcome(Emit(function_, out), Instruction(written), way.path);
      else if (way.fine != no_value && is_noise(written))
        way.fine = with_move(Emit(function_, out), Instruction(written), way.fine);
      else if (way.ends != no_value && is_ray(written))
        way.ends = with_met(Emit(function_, out), std::vector(written.results), way.ends);
      if (jumps && way.bent != no_value && decisions_.bent[out[at].result()])
        way.bent = with_edge(Emit(function_, out), Instruction(out[at]), way.bent);
    }
    region.body = std::move(out);
    return way;
  }

 private:
  static constexpr std::array parts = {&Way::path, &Way::ends, &Way::fine, &Way::bent};

  // A random number, 1 modulo 64.
  std::int32_t next_factor() {
    state_ += 0x9e3779b9u;
    std::uint32_t h = state_;
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return static_cast<std::int32_t>(((h ^ (h >> 16)) & ~63u) | 1u);
  }

  // A bend that is a crease.
  bool is_fold(Op op, Value result) const {
    return cut_of(op) == Cut::kink && decisions_.creases[result];
  }

  bool is_noise(const Instruction& in) const {
    const std::vector<bool>& told = decisions_.noises.told;
    return in.op == Op::call && in.results[0] < told.size() && told[in.results[0]];
  }
  bool is_ray(const Instruction& in) const {
    return in.op == Op::external && !in.results.empty() && in.results[0] < decisions_.rays.size() &&
           decisions_.rays[in.results[0]];
  }
  Value with_move(const Emit& emit, const Instruction& call, Value farthest) const {
    return emit(Op::fmax, {farthest, move_squared(emit, module_, call)});
  }

  Value with_edge(const Emit& emit, const Instruction& decision, Value before) const {
    return emit.choose(is_near(emit, decision, roots_, bounds_, reach_), emit.number(1), before);
  }

  Value outcome(const Emit& emit, const Instruction& in, Value path) {
    const Cut cut = cut_of(in.op);
    const bool is_crease = decisions_.creases[in.result()];
    const std::int32_t number = next_factor() + (is_crease ? one_crease : 0);
    if (is_crease && cut == Cut::kink) {
      const Value below = emit.less(in.operands[0], emit.number(0));
      const Value fold = emit.integer(number - 1);
      return emit(Op::iadd, {path, emit.choose(below, fold, emit.integer(0))});
    }
    const Value factor = emit.integer(cut == Cut::kink ? number << bits_of_jumps : number);
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
      in.results.push_back(function_.add_value(function_.values[before.*part].type));
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

  // A loop each of whose turns may be seen.
  Way turn(Instruction& in, Way before) {
    if (decisions_.is_dither(in)) return before;
    Region& body = in.regions[1];
    std::size_t k = body.params.size();
    Way within = before;
    for (const auto part : parts)
      if (before.*part != no_value) within.*part = carry(in, function_.values[before.*part].type);
    Way after = walk(body, within), result = before;
    const bool differs = function_.values[in.regions[0].yields[0]].rate == ir::Rate::sample;
    if (differs || after.path != within.path) {
      const Emit emit(function_, body.body);
      const Value mixed = emit(Op::imul, {after.path, emit.integer(next_factor())});
      after.path = emit(Op::iadd, {mixed, emit.integer(next_factor())});
    }
    for (const auto part : parts) {
      if (before.*part == no_value) continue;
      if (after.*part == within.*part) {
        for (Region& region : in.regions)
          region.params.erase(region.params.begin() + static_cast<std::ptrdiff_t>(k));
        continue;
      }
      result.*part = finish(in, before.*part, after.*part);
      ++k;
    }
    return result;
  }

  // A loop that searches: every turn's path begins anew.
  Value search(Instruction& in, Value before) {
    Region& body = in.regions[1];
    const Value after = walk(body, {before, no_value, no_value, no_value}).path;
    if (after == before) return before;
    const Emit emit(function_, body.body);
    const Value met = emit.choose(changes(emit, in), after, before);
    carry(in, ir::Type::i32);
    return finish(in, before, met);
  }

  // Whether a turn of a search changes anything that it may end with, or that ends it.
  Value changes(const Emit& emit, const Instruction& loop) const {
    const Region& body = loop.regions[1];
    Value any = emit(Op::const_bool, {}, 0);
    for (std::size_t k = 0; k < body.params.size(); ++k) {
      const Value from = body.params[k], to = body.yields[k];
      if (from == to) continue;
      const ir::Type type = function_.values[to].type;
      const Value end = loop.results[k];
      const bool is_end = end < decisions_.ends.size() && decisions_.ends[end];
      const bool is_flag = type == ir::Type::boolean &&
                           !(end < decisions_.expected.size() && decisions_.expected[end]);
      if (!is_end && !is_flag) continue;
      const Op differ = type == ir::Type::f32   ? Op::fne
                        : type == ir::Type::i32 ? Op::ine
                                                : Op::bxor;
      any = emit(Op::bor, {any, emit(differ, {from, to})});
    }
    return any;
  }

  // The sum with what a search ends with.
  Value with_ends(const Emit& emit, const std::vector<Value>& results, Value sum) {
    has_searches_ = true;
    for (const Value end : results)
      if (end < decisions_.ends.size() && decisions_.ends[end]) sum = with_end(emit, end, sum);
    return sum;
  }

  // The sum with what a ray has met: how bright or how visible that is, or which object. Where it
  // is and which way it is turned may change much from pixel to pixel on one round object too, so
  // that less is made of them. The places themselves change all along it.
  Value with_met(const Emit& emit, const std::vector<Value>& results, Value sum) {
    struct Part {
      std::size_t of_hit;  // surface/trace_call.h
      float weight;
    };
    constexpr std::array parts_of_hit = {Part{0, 0.25f}, Part{7, 0.12f}, Part{8, 0.12f},
                                         Part{9, 0.12f}, Part{12, 1.0f}};
    has_searches_ = true;
    if (results.size() <= 4) {
      for (const Value result : results) sum = with_end(emit, result, sum);
    } else {
      for (const Part& part : parts_of_hit)
        sum = with_end(emit, results[part.of_hit], sum, part.weight);
    }
    return sum;
  }

  Value with_end(const Emit& emit, Value end, Value sum, float part = 1) {
    // 1 to 2, so that no two ends make up for each other.
    const float spread = 1 + static_cast<float>(next_factor() & 0xfff0) * 0x1p-16f;
    const Value weight = emit.number(part * spread);
    const ir::Type type = function_.values[end].type;
    if (type == ir::Type::boolean) return emit.add(sum, emit.choose(end, weight, emit.number(0)));
    const Value value = type == ir::Type::i32 ? emit(Op::i2f, {end}) : end;
    return emit(Op::fma, {size(emit, value), weight, sum});
  }

  // The logarithm to base 2 of 1 + |v|, nearly, with the sign of v; finite.
  static Value size(const Emit& emit, Value v) {
    const Value above = emit.add(emit(Op::fabs, {v}), emit.number(1));
    const Value steps = emit(Op::isub, {emit(Op::f2bits, {above}), emit.integer(0x3f800000)});
    const Value size = emit.mul(emit(Op::i2f, {steps}), emit.number(0x1p-23f));
    return emit.choose(emit.less(v, emit.number(0)), emit(Op::fneg, {size}), size);
  }

  const ir::Module& module_;
  Function& function_;
  const Decisions& decisions_;
  const Roots roots_;
  const SlopeBounds bounds_;
  float reach_;
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

void add_path(ir::Module& module, const Decisions& decisions, float reach) {
  Function& main = module.main();
  std::vector<Instruction> start;
  const Emit first(main, start);
  Paths paths(module, decisions, reach);
  const float untold = decisions.noises.others ? untold_move_squared : 0;
  const Value still = decisions.any_noise ? first.number(untold) : no_value;
  const Value straight = decisions.any_bent ? first.number(0) : no_value;
  const Way none{first.integer(0), first.number(0), still, straight};
  const Way way = paths.walk(main.body, none);
  main.body.body.insert(main.body.body.begin(), std::make_move_iterator(start.begin()),
                        std::make_move_iterator(start.end()));
  const Emit emit(main, main.body.body);
  // Floats hold whole numbers of 24 bits exactly.
  const Value high = emit(Op::ishl, {way.path, emit.integer(8)});
  const Value low = emit(Op::ishr, {high, emit.integer(8)});
  main.body.yields.push_back(emit(Op::i2f, {low}));
  module.outputs.push_back({path_name});
  if (paths.has_searches()) {
    main.body.yields.push_back(way.ends);
    module.outputs.push_back({ends_name});
  }
  const auto add = [&](Value value, const char* name) {
    main.body.yields.push_back(value);
    module.outputs.push_back({name});
  };
  if (decisions.any_noise) add(way.fine, fine_name);
  if (decisions.any_bent) add(way.bent, bent_name);
}

void remove_checks(ir::Module& module) {
  ir::drop_expectations(module);
  for (Function& function : module.functions) remove_checks(function.body);
}

}  // namespace pse::antialias
