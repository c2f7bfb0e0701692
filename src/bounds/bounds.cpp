// The program of the bounds, written from the program region by region.
#include "bounds/bounds.h"

#include <bit>
#include <utility>

#include "bounds/dependence.h"
#include "bounds/operators.h"
#include "ir/expectations.h"
#include "passes/passes.h"

namespace pse::bounds {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Type;
using ir::Value;

class Writer {
 public:
  Writer(ir::Module& module, const Dependence& depends, std::int32_t max_turns)
      : module_(module),
        source_(module.main()),
        depends_(depends),
        max_turns_(max_turns),
        builder_(module, made_),
        functions_(module),
        bounds_(source_.values.size()),
        defined_by_(source_.values.size(), nullptr) {
    made_.name = source_.name;
    made_.arrays = source_.arrays;
    const std::size_t inputs = module.inputs.size();
    for (std::size_t i = 0; i < inputs; ++i) {
      upper_input_.push_back(static_cast<std::int32_t>(module.inputs.size()));
      if (module.inputs[i].rate != ir::Rate::sample) continue;
      module.inputs.push_back({module.inputs[i].name + "$hi", ir::Rate::sample});
      module.inputs[i].name += "$lo";
    }
  }

  // The new entry function.
  ir::Function run() {
    walk(source_.body);
    for (const Value value : source_.body.yields)
      append_ends(builder_, bounds_[value], made_.body.yields);
    return std::move(made_);
  }

 private:
  bool depends(Value value) const { return depends_.values[value]; }
  Value exact(Value value) { return value_of(builder_, bounds_[value]); }
  std::vector<Value> exact(const std::vector<Value>& values) {
    std::vector<Value> made;
    for (const Value value : values) made.push_back(exact(value));
    return made;
  }

  void walk(const Region& region) {
    for (const Instruction& in : region.body) {
      builder_.set_span(in.span);
      for (const Value result : in.results) defined_by_[result] = &in;
      visit(in);
    }
  }

  void visit(const Instruction& in) {
    if (in.op == Op::if_) return depends(in.operands[0]) ? both_sides(in) : one_side(in);
    if (in.op == Op::loop) return depends(in.regions[0].yields[0]) ? open_loop(in) : loop(in);
    if (in.op == Op::check) return;
    const auto array = static_cast<std::size_t>(in.imm);
    if (in.op == Op::array_store || in.op == Op::array_resize) {
      if (depends_.arrays[array]) return;
      const std::vector<Value> operands = exact(in.operands);
      builder_.emit_like(in, operands, {});
      return;
    }
    if (in.results.empty()) return;
    if (!depends(in.results.front())) return copy(in);
    if (in.op == Op::input) {
      bounds_[in.result()] =
          between({{builder_, builder_.emit(Op::input, {}, in.imm)},
                   {builder_, builder_.emit(Op::input, {}, upper_input_[array])}});
      return;
    }
    if (in.op == Op::call) return call(in);
    if (in.op == Op::external || in.op == Op::array_load || in.op == Op::array_length) {
      for (const Value result : in.results) bounds_[result] = unknown(source_.values[result].type);
      return;
    }
    std::vector<Bound> operands;
    for (const Value operand : in.operands) operands.push_back(bounds_[operand]);
    bounds_[in.result()] = bound_operator(module_, in, operands);
    if (in.op == Op::fsub) within_a_step(in);
  }

  // What does not depend on the place is computed as it is.
  void copy(const Instruction& in) {
    if (in.op == Op::const_f32) {
      bounds_[in.result()] = exact_number(in.imm_f32());
      return;
    }
    std::vector<Type> types;
    for (const Value result : in.results) types.push_back(source_.values[result].type);
    const std::vector<Value> operands = exact(in.operands);
    const std::vector<Value> made = builder_.emit_like(in, operands, types);
    for (std::size_t i = 0; i < made.size(); ++i)
      bounds_[in.results[i]] = exact_bound(builder_, made[i]);
  }

  // x - floor(x) lies in [0, 1] wherever x is finite.
  void within_a_step(const Instruction& in) {
    const Instruction* steps = defined_by_[in.operands[1]];
    if (steps == nullptr || steps->op != Op::ffloor || steps->operands[0] != in.operands[0]) return;
    Range& range = bounds_[in.result()].range;
    const auto& x = bounds_[in.operands[0]].range;
    const IrBool finite = x.hi - x.lo < IrFloat(num::infinity);
    range = provided(finite, Range{max(range.lo, IrFloat(0.0f)), min(range.hi, IrFloat(1.0f))});
  }

  void call(const Instruction& in) {
    std::vector<Argument> arguments;
    std::vector<IrInt> keys;
    bool known = true;
    for (const Value operand : in.operands) {
      const Bound& bound = bounds_[operand];
      if (bound.type == Type::f32) arguments.push_back({bound.range, bound.exact});
      if (bound.type == Type::i32) keys.push_back(bound.integer);
      if (bound.type != Type::f32) known = known && bound.exact;
    }
    std::vector<Range> ranges(in.results.size(), anything<IrFloat>());
    if (known) ranges = functions_.call(builder_, in.imm, arguments, keys);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      const Type type = source_.values[in.results[i]].type;
      bounds_[in.results[i]] = type == Type::f32 ? between(ranges[i]) : unknown(type);
    }
  }

  // ---- Conditionals ----------------------------------------------------------------------------

  // Within a side, what its condition says of the numbers compared.
  struct Narrowed {
    Value value;
    Bound before;
  };
  void narrow(Value value, const Range& range, std::vector<Narrowed>& narrowed) {
    Bound& bound = bounds_[value];
    if (bound.exact) return;
    narrowed.push_back({value, bound});
    bound.range = range;
  }
  void assume(Value condition, bool is_true, std::vector<Narrowed>& narrowed) {
    const Instruction* in = defined_by_[condition];
    if (in == nullptr) return;
    if (in->op == Op::bnot) return assume(in->operands[0], !is_true, narrowed);
    if (in->op == (is_true ? Op::band : Op::bor)) {
      for (const Value part : in->operands) assume(part, is_true, narrowed);
      return;
    }
    if (in->op != Op::flt && in->op != Op::fle) return;
    // Below and above; where a comparison is false, the other way around, or one is NaN.
    const Value low = in->operands[is_true ? 0 : 1], high = in->operands[is_true ? 1 : 0];
    const Range below = bounds_[low].range, above = bounds_[high].range;
    const auto keep = [&](const Range& range, const Range& kept) {
      if (is_true) return kept;
      const IrBool nan = either(may_be_nan(below), may_be_nan(above));
      return Range{select(nan, range.lo, kept.lo), select(nan, range.hi, kept.hi)};
    };
    narrow(low, keep(below, {below.lo, select(above.hi < below.hi, above.hi, below.hi)}), narrowed);
    narrow(high, keep(above, {select(below.lo > above.lo, below.lo, above.lo), above.hi}),
           narrowed);
  }

  // A side of a conditional as a region that yields `ends`.
  template <class Ends>
  Region side(const Instruction& in, bool is_true, const Ends& ends) {
    Region region;
    builder_.begin_region(region);
    std::vector<Narrowed> narrowed;
    if (depends(in.operands[0])) assume(in.operands[0], is_true, narrowed);
    const Region& source = in.regions[is_true ? 0 : 1];
    walk(source);
    for (std::size_t i = 0; i < in.results.size(); ++i)
      ends(i, bounds_[source.yields[i]], region.yields);
    for (std::size_t i = narrowed.size(); i-- > 0;) bounds_[narrowed[i].value] = narrowed[i].before;
    builder_.end_region();
    return region;
  }

  // The condition is the same everywhere.
  void one_side(const Instruction& in) {
    const auto ends = [&](std::size_t i, const Bound& bound, std::vector<Value>& yields) {
      if (depends(in.results[i]))
        append_ends(builder_, bound, yields);
      else
        yields.push_back(value_of(builder_, bound));
    };
    Region yes = side(in, true, ends), no = side(in, false, ends);
    const std::vector<Value> made =
        builder_.emit_if(exact(in.operands[0]), std::move(yes), std::move(no));
    take_results(in, made);
  }

  void take_results(const Instruction& in, const std::vector<Value>& made) {
    std::size_t next = 0;
    for (const Value result : in.results) {
      const Type type = source_.values[result].type;
      if (depends(result)) {
        bounds_[result] = from_ends(builder_, type, made.data() + next);
        next += count_ends(type);
      } else {
        bounds_[result] = exact_bound(builder_, made[next++]);
      }
    }
  }

  // Each side where it may be taken, and the hull of both.
  void both_sides(const Instruction& in) {
    const Bound condition = bounds_[in.operands[0]];
    const auto run = [&](bool is_true, const IrBool& guard) {
      const auto ends = [&](std::size_t, const Bound& bound, std::vector<Value>& yields) {
        append_ends(builder_, bound, yields);
      };
      Region taken = side(in, is_true, ends);
      Region skipped;
      builder_.begin_region(skipped);
      for (const Value result : in.results)
        append_ends(builder_, nowhere(source_.values[result].type), skipped.yields);
      builder_.end_region();
      take_results(in,
                   builder_.emit_if(place(builder_, guard), std::move(taken), std::move(skipped)));
      std::vector<Bound> results;
      for (const Value result : in.results) results.push_back(bounds_[result]);
      return results;
    };
    const std::vector<Bound> yes = run(true, condition.may);
    const std::vector<Bound> no = run(false, negate(condition.must));
    for (std::size_t i = 0; i < in.results.size(); ++i)
      bounds_[in.results[i]] = hull(yes[i], no[i]);
  }

  // ---- Loops -----------------------------------------------------------------------------------

  void push(const Bound& bound, bool as_ends, std::vector<Value>& values) {
    if (as_ends)
      append_ends(builder_, bound, values);
    else
      values.push_back(value_of(builder_, bound));
  }
  // Parameters of a region for what a loop carries.
  Bound add_param(Region& region, Type type, bool as_ends) {
    if (!as_ends) return exact_bound(builder_, builder_.add_param(region, type));
    if (type == Type::i32) return unknown(type);
    const Value lo = builder_.add_param(region, type), hi = builder_.add_param(region, type);
    const Value ends[] = {lo, hi};
    return from_ends(builder_, type, ends);
  }

  // It ends after the same turn everywhere.
  void loop(const Instruction& in) {
    std::vector<Value> initial;
    for (std::size_t i = 0; i < in.results.size(); ++i)
      push(bounds_[in.operands[i]], depends(in.regions[0].params[i]), initial);
    const auto write = [&](const Region& source) {
      Region region;
      builder_.begin_region(region);
      for (const Value param : source.params)
        bounds_[param] = add_param(region, source_.values[param].type, depends(param));
      walk(source);
      builder_.end_region();
      return region;
    };
    Region head = write(in.regions[0]);
    builder_.begin_region(head);
    head.yields.push_back(exact(in.regions[0].yields[0]));
    builder_.end_region();
    Region body = write(in.regions[1]);
    builder_.begin_region(body);
    for (std::size_t i = 0; i < in.results.size(); ++i)
      push(bounds_[in.regions[1].yields[i]], depends(in.regions[1].params[i]), body.yields);
    builder_.end_region();
    take_results(in, builder_.emit_loop(initial, std::move(head), std::move(body)));
  }

  // It goes on as long as it may, and its results are the hull of what it carries whenever it may
  // have ended. Parameters: what it carries; the hull so far; the turns left.
  void open_loop(const Instruction& in) {
    const std::size_t count = in.results.size();
    std::vector<Value> initial;
    for (std::size_t i = 0; i < count; ++i)
      push(bounds_[in.operands[i]], depends(in.regions[0].params[i]), initial);
    for (const Value result : in.results)
      append_ends(builder_, nowhere(source_.values[result].type), initial);
    initial.push_back(builder_.const_i32(max_turns_));

    struct State {
      std::vector<Bound> ended;  // hull of what was carried where it may have ended
      IrInt left;
      Bound condition;
    };
    // The start of both regions: the parameters, and whether it goes on.
    const auto begin = [&](Region& region, const std::vector<Value>& carried) {
      State state;
      for (std::size_t i = 0; i < count; ++i) {
        const Type type = source_.values[carried[i]].type;
        bounds_[carried[i]] = add_param(region, type, depends(in.regions[0].params[i]));
      }
      for (const Value result : in.results)
        state.ended.push_back(add_param(region, source_.values[result].type, true));
      state.left = {builder_, builder_.add_param(region, Type::i32)};
      // The condition is computed from the head's own parameters.
      for (std::size_t i = 0; i < count; ++i)
        bounds_[in.regions[0].params[i]] = bounds_[carried[i]];
      walk(in.regions[0]);
      state.condition = bounds_[in.regions[0].yields[0]];
      return state;
    };
    const auto with_ended = [&](const State& state, const std::vector<Bound>& carried) {
      std::vector<Bound> ended;
      for (std::size_t i = 0; i < count; ++i) {
        Bound grown = hull(state.ended[i], carried[i]);
        const Bound& before = state.ended[i];
        if (grown.type == Type::f32)
          grown.range = {select(state.condition.must, before.range.lo, grown.range.lo),
                         select(state.condition.must, before.range.hi, grown.range.hi)};
        if (grown.type == Type::boolean) {
          grown.must = either(both(state.condition.must, before.must), grown.must);
          grown.must = both(grown.must, before.must);
          grown.may = either(before.may, both(negate(state.condition.must), grown.may));
        }
        ended.push_back(grown);
      }
      return ended;
    };
    const auto bounds_of = [&](const std::vector<Value>& values) {
      std::vector<Bound> found;
      for (const Value value : values) found.push_back(bounds_[value]);
      return found;
    };

    Region head;
    builder_.begin_region(head);
    const State at_head = begin(head, in.regions[0].params);
    head.yields.push_back(place(builder_, both(at_head.condition.may, IrInt(0) < at_head.left)));
    builder_.end_region();

    Region body;
    builder_.begin_region(body);
    const State here = begin(body, in.regions[1].params);
    const std::vector<Bound> ended = with_ended(here, bounds_of(in.regions[1].params));
    // Where it goes on, the condition holds.
    std::vector<Narrowed> narrowed;
    assume(in.regions[0].yields[0], true, narrowed);
    for (std::size_t i = 0; i < count; ++i)
      bounds_[in.regions[1].params[i]] = bounds_[in.regions[0].params[i]];
    walk(in.regions[1]);
    for (std::size_t i = narrowed.size(); i-- > 0;) bounds_[narrowed[i].value] = narrowed[i].before;
    for (std::size_t i = 0; i < count; ++i)
      push(bounds_[in.regions[1].yields[i]], depends(in.regions[0].params[i]), body.yields);
    for (const Bound& bound : ended) append_ends(builder_, bound, body.yields);
    body.yields.push_back(place(builder_, here.left - IrInt(1)));
    builder_.end_region();

    // The last state: it has ended everywhere, or the turns were used up.
    const std::vector<Value> made = builder_.emit_loop(initial, std::move(head), std::move(body));
    std::size_t next = 0;
    std::vector<Bound> carried;
    for (std::size_t i = 0; i < count; ++i) {
      const Type type = source_.values[in.results[i]].type;
      if (depends(in.regions[0].params[i])) {
        carried.push_back(from_ends(builder_, type, made.data() + next));
        next += count_ends(type);
      } else {
        carried.push_back(exact_bound(builder_, made[next++]));
      }
    }
    const IrBool finished = IrInt(0) < IrInt(builder_, made.back());
    for (std::size_t i = 0; i < count; ++i) {
      const Type type = source_.values[in.results[i]].type;
      Bound result = hull(from_ends(builder_, type, made.data() + next), carried[i]);
      next += count_ends(type);
      if (type == Type::f32) result.range = provided(finished, result.range);
      if (type == Type::boolean) {
        result.must = both(result.must, finished);
        result.may = either(result.may, negate(finished));
      }
      bounds_[in.results[i]] = result;
    }
  }

  ir::Module& module_;
  const ir::Function source_;
  const Dependence& depends_;
  const std::int32_t max_turns_;
  ir::Function made_;
  ir::Builder builder_;
  Functions functions_;
  std::vector<Bound> bounds_;                   // per value of the source
  std::vector<const Instruction*> defined_by_;  // likewise
  std::vector<std::int32_t> upper_input_;       // per input: where its upper ends are
};

// Inputs that are known become constants.
void set_known(Region& region, const ir::Module& module,
               const std::map<std::string, float>& known) {
  for (Instruction& in : region.body) {
    for (Region& inner : in.regions) set_known(inner, module, known);
    if (in.op != Op::input) continue;
    const auto found = known.find(module.inputs[static_cast<std::size_t>(in.imm)].name);
    if (found == known.end()) continue;
    in.op = Op::const_f32;
    in.imm = std::bit_cast<std::int32_t>(found->second);
  }
}

}  // namespace

void bound_outputs(ir::Module& module, const Options& options) {
  // Only what the outputs need, and of that only what the known inputs leave.
  ir::drop_expectations(module);
  set_known(module.main().body, module, options.known);
  passes::remove_dead(module);
  passes::fold(module);
  passes::share(module);  // what is the same value is seen to be
  passes::simplify_loops(module);
  passes::remove_dead(module);

  const Dependence depends = find_dependence(module);
  Writer writer(module, depends, options.max_turns);
  module.main() = writer.run();

  std::vector<ir::Output> outputs;
  for (const ir::Output& output : module.outputs)
    for (const char* end : {"$lo", "$hi"}) outputs.push_back({output.name + end});
  module.outputs = std::move(outputs);
}

}  // namespace pse::bounds
