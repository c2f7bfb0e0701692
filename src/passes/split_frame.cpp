// The frame's half of the program: see split.cpp.
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

class FrameCut {
 public:
  FrameCut(const Function& program, const std::vector<Value>& slots)
      : slot_of_(program.values.size(), no_slot) {
    frame_.name = "frame";
    frame_.values = program.values;
    frame_.arrays = program.arrays;
    for (std::uint32_t i = 0; i < slots.size(); ++i) slot_of_[slots[i]] = i;
    slot_values_.resize(slots.size(), ir::no_value);
  }

  Function run(const Function& program) {
    std::vector<Export> exports;
    cut(program.body, frame_.body, exports, false);
    for (const Export& found : exports) slot_values_[found.slot] = found.value;
    for (const Value value : slot_values_) frame_.body.yields.push_back(encode(value));
    return std::move(frame_);
  }

 private:
  static constexpr std::uint32_t no_slot = 0xffffffffu;

  // A value that must reach the end of the function.
  struct Export {
    std::uint32_t slot;
    Value value;
  };

  bool of_frame(Value value) const { return frame_.values[value].rate != Rate::sample; }

  void cut(const Region& region, Region& out, std::vector<Export>& exports, bool in_loop) {
    out.body.reserve(region.body.size());
    for (const Instruction& in : region.body) {
      if (!belongs(in)) continue;
      if (in.op == Op::if_) {
        copy_if(in, out, exports, in_loop);
      } else if (in.op == Op::loop) {
        copy_loop(in, out);
      } else {
        out.body.push_back(in);
      }
      if (in_loop) continue;
      for (const Value result : in.results) {
        if (slot_of_[result] != no_slot) exports.push_back({slot_of_[result], result});
      }
    }
  }

  bool belongs(const Instruction& in) const {
    if (in.op == Op::check || in.op == Op::if_) return of_frame(in.operands[0]);
    if (in.op == Op::loop) return of_frame(in.regions[0].yields[0]);
    if (writes_array(in.op))
      return frame_.arrays[static_cast<std::size_t>(in.imm)].rate != Rate::sample;
    return !in.results.empty() && of_frame(in.results[0]);
  }

  // Where the k-th of `wanted` is of rate frame, keeps the k-th of `values`.
  std::vector<Value> select(const std::vector<Value>& values,
                            const std::vector<Value>& wanted) const {
    std::vector<Value> kept;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (of_frame(wanted[i])) kept.push_back(values[i]);
    }
    return kept;
  }

  // A slot's value computed in one side becomes a further result; the other side gives 0, which
  // nobody reads.
  void copy_if(const Instruction& in, Region& out, std::vector<Export>& exports, bool in_loop) {
    Instruction made{.op = in.op,
                     .operands = in.operands,
                     .results = select(in.results, in.results),
                     .span = in.span};
    made.regions.resize(2);
    std::vector<Export> found[2];
    for (std::size_t side = 0; side < 2; ++side) {
      cut(in.regions[side], made.regions[side], found[side], in_loop);
      made.regions[side].yields = select(in.regions[side].yields, in.results);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      for (const Export& inner : found[side]) {
        const Type type = frame_.values[inner.value].type;
        made.regions[side].yields.push_back(inner.value);
        made.regions[1 - side].yields.push_back(emit_zero(made.regions[1 - side], type, in.span));
        made.results.push_back(frame_.add_value(type));
        exports.push_back({inner.slot, made.results.back()});
      }
    }
    out.body.push_back(std::move(made));
  }

  void copy_loop(const Instruction& in, Region& out) {
    const std::vector<Value>& carried = in.regions[0].params;
    Instruction made{.op = in.op,
                     .operands = select(in.operands, carried),
                     .results = select(in.results, carried),
                     .span = in.span};
    made.regions.resize(2);
    std::vector<Export> none;
    for (std::size_t i = 0; i < 2; ++i) {
      made.regions[i].params = select(in.regions[i].params, carried);
      cut(in.regions[i], made.regions[i], none, true);
    }
    made.regions[0].yields = in.regions[0].yields;
    made.regions[1].yields = select(in.regions[1].yields, carried);
    out.body.push_back(std::move(made));
  }

  Value emit_zero(Region& region, Type type, const Span& span) {
    const Op op = type == Type::f32   ? Op::const_f32
                  : type == Type::i32 ? Op::const_i32
                                      : Op::const_bool;
    region.body.push_back({.op = op, .results = {frame_.add_value(type)}, .span = span});
    return region.body.back().result();
  }

  // A slot is a float: integers travel as bits, booleans as 1 or 0.
  Value encode(Value value) {
    const Type type = frame_.values[value].type;
    if (type == Type::f32) return value;
    Region& body = frame_.body;
    Instruction made{.op = Op::bits2f, .operands = {value}};
    if (type == Type::boolean) {
      const Value one = emit_zero(body, Type::f32, {});
      body.body.back().imm = __builtin_bit_cast(std::int32_t, 1.0f);
      made.op = Op::select;
      made.operands = {value, one, emit_zero(body, Type::f32, {})};
    }
    made.results = {frame_.add_value(Type::f32)};
    body.body.push_back(std::move(made));
    return body.body.back().result();
  }

  Function frame_;
  std::vector<std::uint32_t> slot_of_;
  std::vector<Value> slot_values_;
};

}  // namespace

Function cut_frame_function(const Function& program, const std::vector<Value>& slots) {
  return FrameCut(program, slots).run(program);
}

}  // namespace pse::passes
