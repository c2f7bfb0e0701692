// Conditions that ranges decide: an index that was clamped is within its array, so its check is
// true. One walk in order of definition; of loops only counters are understood.
#include <bit>
#include <cmath>
#include <optional>

#include "passes/passes.h"
#include "passes/range.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Type;
using ir::Value;

Range range_of_table(const auto& entries) {
  Range range = exactly(static_cast<double>(entries.front()));
  for (const auto entry : entries) range = hull(range, exactly(static_cast<double>(entry)));
  return range;
}

class Decider {
 public:
  Decider(const ir::Module& module, Function& function)
      : function_(function),
        ranges_(function.values.size()),
        definitions_(function.values.size(), nullptr) {
    for (const ir::FloatTable& table : module.float_tables)
      float_tables_.push_back(range_of_table(table.entries));
    for (const ir::IntTable& table : module.int_tables)
      int_tables_.push_back(range_of_table(table.entries));
    for (std::size_t i = 0; i < ranges_.size(); ++i)
      ranges_[i] = full_range(function.values[i].type);
  }

  void run() {
    find_definitions(function_.body);
    walk(function_.body);
  }

 private:
  void find_definitions(const Region& region) {
    for (const Instruction& in : region.body) {
      for (const Value result : in.results) definitions_[result] = &in;
      for (const Region& inner : in.regions) find_definitions(inner);
    }
  }

  void walk(Region& region) {
    for (Instruction& in : region.body) {
      if (in.op == Op::loop) enter_loop(in);
      for (Region& inner : in.regions) walk(inner);
      if (in.op == Op::if_) leave_if(in);
      if (has_regions(in.op) || in.results.size() != 1) continue;
      Range& range = ranges_[in.result()];
      range = find_range(in);
      const bool is_known =
          function_.values[in.result()].type == Type::boolean && range.lo == range.hi;
      if (!is_known || is_constant(in.op)) continue;
      in.op = Op::const_bool;
      in.imm = range.lo != 0;
      in.operands.clear();
    }
  }

  Range find_range(const Instruction& in) const {
    const Type type = function_.values[in.result()].type;
    const auto operand = [&](std::size_t i) {
      return i < in.operands.size() ? ranges_[in.operands[i]] : Range{};
    };
    switch (in.op) {
      case Op::const_f32:
        return exactly(double{in.imm_f32()});
      case Op::const_i32:
        return exactly(double{static_cast<double>(in.imm)});
      case Op::const_bool:
        return exactly(in.imm != 0);
      case Op::table_f32:
        return float_tables_[static_cast<std::size_t>(in.imm)];
      case Op::table_i32:
        return int_tables_[static_cast<std::size_t>(in.imm)];
      case Op::array_length:
        return {0, static_cast<double>(function_.arrays[static_cast<std::size_t>(in.imm)].capacity),
                false};
      default:
        break;
    }
    // A square is not negative.
    Range range = range_of(in.op, operand(0), operand(1), operand(2), type);
    if (in.op == Op::fmul && in.operands[0] == in.operands[1]) range.lo = std::fmax(range.lo, 0.0);
    return range;
  }

  void leave_if(const Instruction& in) {
    const Range condition = ranges_[in.operands[0]];
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      const Range yes = ranges_[in.regions[0].yields[i]], no = ranges_[in.regions[1].yields[i]];
      ranges_[in.results[i]] = condition.is(1) ? yes : condition.is(0) ? no : hull(yes, no);
    }
  }

  // A parameter that starts at a known place and grows by a constant while it is below a limit.
  void enter_loop(const Instruction& loop) {
    const Region& head = loop.regions[0];
    const Region& body = loop.regions[1];
    for (std::size_t i = 0; i < loop.operands.size(); ++i) {
      if (function_.values[head.params[i]].type != Type::i32) continue;
      const auto step = step_of(body.yields[i], body.params[i]);
      const auto limit = limit_of(head.yields[0], head.params[i]);
      const Range start = ranges_[loop.operands[i]];
      if (!step || !limit || *limit + *step > 2147483647.0) continue;
      ranges_[body.params[i]] = {start.lo, *limit, false};
      ranges_[head.params[i]] = {start.lo, std::fmax(start.hi, *limit + *step), false};
      ranges_[loop.results[i]] = ranges_[head.params[i]];
    }
  }

  // c where `next` is param + c with c > 0.
  std::optional<double> step_of(Value next, Value param) const {
    const Instruction* in = definitions_[next];
    if (!in || in->op != Op::iadd) return {};
    const Value other = in->operands[0] == param ? in->operands[1] : in->operands[0];
    const Instruction* by = definitions_[other];
    const bool adds = in->operands[0] == param || in->operands[1] == param;
    if (!adds || !by || by->op != Op::const_i32 || by->imm <= 0) return {};
    return by->imm;
  }

  // The largest value that `param` can have where `condition` holds.
  std::optional<double> limit_of(Value condition, Value param) const {
    const Instruction* in = definitions_[condition];
    if (!in) return {};
    if (in->op == Op::band) {
      const auto first = limit_of(in->operands[0], param);
      return first ? first : limit_of(in->operands[1], param);
    }
    if ((in->op != Op::ilt && in->op != Op::ile) || in->operands[0] != param) return {};
    // Values of the head itself are not known yet; they have their full range.
    const double highest = ranges_[in->operands[1]].hi;
    return in->op == Op::ilt ? highest - 1 : highest;
  }

  Function& function_;
  std::vector<Range> ranges_;
  std::vector<const Instruction*> definitions_;
  std::vector<Range> float_tables_;
  std::vector<Range> int_tables_;
};

}  // namespace

void decide(ir::Module& module) {
  for (Function& function : module.functions) Decider(module, function).run();
}

}  // namespace pse::passes
