// One walk over the main function; values of conditions within an `if` come out of it by its
// yields.
#include "antialias/force.h"

#include <limits>

#include "passes/emit.h"
#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;
using passes::Emit;

// Loops with a known number of turns are written out, so that the conditions of each turn count.
constexpr passes::UnrollOptions written_out = {.max_instructions = 2000};

class Opening {
 public:
  Opening(Function& function, const Decisions& decisions)
      : function_(function), decisions_(decisions) {}

  void run(std::int32_t high_input, std::int32_t low_input) {
    std::vector<Instruction> start;
    const Emit emit(function_, start);
    // The masks, and what a condition's value is where the program does not come by.
    const auto mask = [&](std::int32_t input) {
      return emit(Op::f2i, {emit(Op::input, {}, input)});
    };
    high_ = mask(high_input), low_ = mask(low_input);
    nothing_ = emit.number(std::numeric_limits<float>::quiet_NaN());
    walk(function_.body);
    function_.body.body.insert(function_.body.body.begin(), start.begin(), start.end());
  }

  const std::vector<Value>& values() const { return values_; }
  const std::vector<bool>& steps() const { return steps_; }

 private:
  void walk(Region& region) {
    std::vector<Instruction> out;
    out.reserve(region.body.size() + 16);
    for (Instruction& in : region.body) {
      if (in.op == Op::if_)
        branch(in, out);
      else if (is_condition(in))
        open(in, out);
      else
        out.push_back(std::move(in));
    }
    region.body = std::move(out);
  }

  bool is_condition(const Instruction& in) const {
    if (in.results.size() != 1 || in.result() >= decisions_.forks.size() ||
        !decisions_.forks[in.result()] || values_.size() >= most_conditions)
      return false;
    const Cut cut = cut_of(in.op);
    return cut == Cut::compare || cut == Cut::whole || cut == Cut::half;
  }

  void open(Instruction& in, std::vector<Instruction>& out) {
    const Emit emit(function_, out);
    const auto bit = static_cast<std::int32_t>(values_.size());
    const auto is_set = [&](Value mask) {
      const Value low =
          emit(Op::iand, {emit(Op::ishr, {mask, emit.integer(bit)}), emit.integer(1)});
      return emit(Op::ieq, {low, emit.integer(1)});
    };
    const Value high = is_set(high_), low = is_set(low_);
    const Cut cut = cut_of(in.op);
    steps_.push_back(cut != Cut::compare);
    if (cut == Cut::compare) {
      values_.push_back(emit.sub(in.operands[1], in.operands[0]));
      // The forced outcome takes the name of the free one.
      const Value outcome = in.result();
      Instruction compared = in;
      compared.results = {function_.add_value(ir::Type::boolean)};
      const Value natural = compared.result();
      out.push_back(std::move(compared));
      const Value raised = emit(Op::bor, {natural, high});
      out.push_back({.op = Op::band,
                     .operands = {raised, emit(Op::bnot, {low})},
                     .results = {outcome},
                     .span = in.span});
      return;
    }
    // A quarter beyond the nearest step, or before it.
    const Value a = in.operands[0];
    const Value shifted = cut == Cut::half ? emit.sub(a, emit.number(0.5f)) : a;
    values_.push_back(shifted);
    const Value nearest = emit.add(emit(Op::fround, {shifted}), emit.sub(a, shifted));
    const Value beyond = emit.add(nearest, emit.number(0.25f));
    const Value before = emit.sub(nearest, emit.number(0.25f));
    in.operands[0] = emit.choose(high, beyond, emit.choose(low, before, a));
    out.push_back(std::move(in));
  }

  void branch(Instruction& in, std::vector<Instruction>& out) {
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t first = values_.size();
      if (!decisions_.is_dither(in)) walk(in.regions[side]);
      for (std::size_t k = first; k < values_.size(); ++k) {
        in.regions[side].yields.push_back(values_[k]);
        in.regions[1 - side].yields.push_back(nothing_);
        in.results.push_back(function_.add_value(ir::Type::f32));
        values_[k] = in.results.back();
      }
    }
    out.push_back(std::move(in));
  }

  Function& function_;
  const Decisions& decisions_;
  Value high_ = ir::no_value, low_ = ir::no_value, nothing_ = ir::no_value;
  std::vector<Value> values_;
  std::vector<bool> steps_;
};

}  // namespace

void open_conditions(ir::Module& module) {
  passes::remove_dead(module);
  passes::fold(module);
  passes::unroll(module, written_out);
  passes::fold(module);
  const Decisions decisions = find_decisions(module);
  const auto inputs = static_cast<std::int32_t>(module.inputs.size());
  module.inputs.push_back({force_high_name});
  module.inputs.push_back({force_low_name});
  Opening opening(module.main(), decisions);
  opening.run(inputs, inputs + 1);
  for (std::size_t k = 0; k < opening.values().size(); ++k) {
    const char* suffix = opening.steps()[k] ? step_suffix : "";
    module.outputs.push_back({condition_name + std::to_string(k) + suffix});
    module.main().body.yields.push_back(opening.values()[k]);
  }
}

}  // namespace pse::antialias
