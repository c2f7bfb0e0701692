// The sample's half of the program: see split.cpp.
#include <algorithm>
#include <utility>

#include "passes/rewrite.h"
#include "passes/split_functions.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Rate;
using ir::Region;
using ir::Type;
using ir::Value;

class SampleCut {
 public:
  SampleCut(const Function& program, std::size_t first_slot)
      : first_slot_(first_slot),
        renaming_(program.values.size()),
        at_hand_(program.values.size(), false) {
    result_.function.name = program.name;
    result_.function.values = program.values;
    result_.function.arrays = program.arrays;
  }

  SampleFunction run(const Function& program) {
    std::vector<Instruction> body = cut(program.body, true, false);
    result_.function.body.yields = program.body.yields;
    renaming_.apply(result_.function.body.yields);
    // Slots are read first.
    std::ranges::move(body, std::back_inserter(reads_));
    result_.function.body.body = std::move(reads_);
    return std::move(result_);
  }

 private:
  bool of_frame(Value value) const { return result_.function.values[value].rate != Rate::sample; }

  // `frame`: the region runs alike for all samples of a frame.
  std::vector<Instruction> cut(const Region& region, bool frame, bool in_loop) {
    std::vector<Instruction> out;
    out.reserve(region.body.size());
    for (const Instruction& in : region.body) {
      if (frame && is_effect_of_frame(in)) continue;
      if (frame && !in_loop && is_at_hand(in)) {
        at_hand_[in.result()] = true;
      } else if (frame && !in_loop) {
        for (const Value result : in.results) {
          if (of_frame(result)) add_slot(result, in.span);
        }
        // What is all in slots need not stay, unless the sample has a part in it.
        const bool all =
            std::ranges::all_of(in.results, [&](Value value) { return of_frame(value); });
        if (all && !has_regions(in.op) && !in.results.empty()) continue;
      }
      out.push_back(copy(in, frame, in_loop));
    }
    return out;
  }

  Instruction copy(const Instruction& in, bool frame, bool in_loop) {
    Instruction made{.op = in.op,
                     .operands = in.operands,
                     .imm = in.imm,
                     .component = in.component,
                     .span = in.span};
    renaming_.apply(made.operands);
    // A result that went to a slot has a new name there; the old one stays with the copy, unused.
    made.results = in.results;
    const bool is_loop = in.op == Op::loop;
    for (const Region& region : in.regions) {
      const Value condition = is_loop ? in.regions[0].yields[0] : in.operands[0];
      Region inner{.params = region.params};
      inner.body = cut(region, frame && of_frame(condition), in_loop || is_loop);
      inner.yields = region.yields;
      renaming_.apply(inner.yields);
      made.regions.push_back(std::move(inner));
    }
    return made;
  }

  bool is_effect_of_frame(const Instruction& in) const {
    if (in.op == Op::check) return of_frame(in.operands[0]);
    return writes_array(in.op) &&
           result_.function.arrays[static_cast<std::size_t>(in.imm)].rate != Rate::sample;
  }

  // Constants, inputs, and what is as cheap from those as reading a slot would be.
  bool is_at_hand(const Instruction& in) const {
    if (is_constant(in.op) || in.op == Op::input) return true;
    const bool is_cheap = in.op == Op::fneg || in.op == Op::fabs || in.op == Op::bnot ||
                          (in.op >= Op::feq && in.op <= Op::fle) ||
                          (in.op >= Op::ieq && in.op <= Op::ile);
    return is_cheap &&
           std::ranges::all_of(in.operands, [&](Value value) { return at_hand_[value]; });
  }

  Value emit(Op op, std::vector<Value> operands, Type type, std::int32_t imm, const Span& span) {
    const Value value = result_.function.add_value(type);
    reads_.push_back(
        {.op = op, .operands = std::move(operands), .results = {value}, .imm = imm, .span = span});
    return value;
  }

  void add_slot(Value value, const Span& span) {
    const auto slot = static_cast<std::int32_t>(first_slot_ + result_.candidates.size());
    result_.candidates.push_back(value);
    const Value read = emit(Op::input, {}, Type::f32, slot, span);
    switch (result_.function.values[value].type) {
      case Type::f32:
        return renaming_.set(value, read);
      case Type::i32:
        return renaming_.set(value, emit(Op::f2bits, {read}, Type::i32, 0, span));
      case Type::boolean: {
        const Value zero = emit(Op::const_f32, {}, Type::f32, 0, span);
        return renaming_.set(value, emit(Op::fne, {read, zero}, Type::boolean, 0, span));
      }
    }
  }

  std::size_t first_slot_;
  Renaming renaming_;
  std::vector<bool> at_hand_;
  std::vector<Instruction> reads_;
  SampleFunction result_;
};

}  // namespace

SampleFunction cut_sample_function(const Function& program, std::size_t first_slot) {
  return SampleCut(program, first_slot).run(program);
}

}  // namespace pse::passes
