// One function after the other, region by region: each instruction is followed by those of its
// slopes. Functions are derived once for each set of arguments that have slopes.
#include "antialias/derive.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "antialias/activity.h"
#include "antialias/edge_state.h"
#include "antialias/rotate.h"
#include "antialias/rules.h"
#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Region;
using ir::Value;

constexpr std::size_t directions = 2;
using Slopes = std::array<Value, directions>;
constexpr Slopes none = {no_value, no_value};
using Directions = std::array<bool, directions>;  // in which a value changes

class ModuleDeriver {
 public:
  ModuleDeriver(ir::Module& m, const InputChanges& changes) : module(m), activity_(m) {
    const std::size_t inputs = m.inputs.size();
    for (std::size_t k = 0; k < inputs; ++k) {
      slope_inputs_.push_back({no_input, no_input});
      if (module.inputs[k].rate != ir::Rate::sample) continue;
      const std::string name = module.inputs[k].name;
      const auto [along_x, along_y] = changes(name);
      for (const bool is_x : {true, false}) {
        const Change change = is_x ? along_x : along_y;
        if (change == Change::none) continue;
        slope_inputs_.back()[is_x ? 0 : 1] = static_cast<std::int32_t>(module.inputs.size());
        module.inputs.push_back({name + (is_x ? "$x" : "$y"),
                                 change == Change::even ? ir::Rate::frame : ir::Rate::sample});
      }
    }
  }

  const Active& active(std::uint32_t function, const std::vector<bool>& parameters) {
    return activity_.of(function, parameters);
  }
  // The inputs that are the slopes of an input; no_input where it does not change.
  const std::array<std::int32_t, directions>& slope_inputs(std::int32_t input) const {
    return slope_inputs_[static_cast<std::size_t>(input)];
  }
  static constexpr std::int32_t no_input = -1;
  // The function that gives the results and their slopes: parameters, then those slopes of each
  // that are not 0; results, then two slopes for each that has any.
  std::uint32_t derived(std::uint32_t function, const std::vector<Directions>& parameters);

  ir::Module& module;

 private:
  Activity activity_;
  std::vector<std::array<std::int32_t, directions>> slope_inputs_;
  std::map<std::pair<std::uint32_t, std::vector<Directions>>, std::uint32_t> derived_;
};

class FunctionDeriver {
 public:
  FunctionDeriver(ModuleDeriver& all, Function& function, const Active& active,
                  const Decisions* decisions)
      : all_(all),
        function_(function),
        active_(active),
        decisions_(decisions),
        slopes_(function.values.size(), none),
        shadow_(function.arrays.size(), -1) {}

  void run(const std::vector<Directions>& parameters) {
    for (std::size_t i = 0; i < parameters.size(); ++i)
      add_slope_params(function_.body, function_.body.params[i], parameters[i]);
    for (std::size_t a = 0; a < shadow_.size(); ++a) {
      if (!active_.arrays[a]) continue;
      shadow_[a] = static_cast<std::int32_t>(function_.arrays.size());
      for (std::size_t k = 0; k < directions; ++k) {
        ir::Array copy = function_.arrays[a];
        copy.name += k == 0 ? "$x" : "$y";
        function_.arrays.push_back(std::move(copy));
      }
    }
    std::vector<Instruction> start;
    if (decisions_) edges_ = start_edges(Emit(function_, start));
    walk(function_.body);
    function_.body.body.insert(function_.body.body.begin(), start.begin(), start.end());
  }

  // The slopes of the results that have them, behind the results.
  void yield_slopes(bool all_results) {
    const Emit emit(function_, function_.body.body);
    const std::size_t count = function_.body.yields.size();
    for (std::size_t i = 0; i < count; ++i)
      if (all_results || active_.results[i])
        for (const Value slope : present(emit, function_.body.yields[i]))
          function_.body.yields.push_back(slope);
  }

  const EdgeState& edges() const { return *edges_; }

 private:
  bool is_active(Value value) const {
    return value < active_.values.size() && active_.values[value];
  }
  Slopes slopes(Value value) const { return value < slopes_.size() ? slopes_[value] : none; }
  void set(Value value, const Slopes& slopes) {
    if (value >= slopes_.size()) slopes_.resize(value + 1, none);
    slopes_[value] = slopes;
  }
  // Slopes as values: 0 where there are none.
  Slopes present(const Emit& emit, Value value) const {
    Slopes found = slopes(value);
    for (Value& slope : found)
      if (slope == no_value) slope = emit.number(0);
    return found;
  }
  void add_slope_params(Region& region, Value param, const Directions& wanted = {true, true}) {
    Slopes made = none;
    for (std::size_t k = 0; k < directions; ++k)
      if (wanted[k]) region.params.push_back(made[k] = function_.add_value(ir::Type::f32));
    set(param, made);
  }
  void add_slope_results(Instruction& in, Value result) {
    Slopes made;
    for (Value& slope : made) {
      slope = function_.add_value(ir::Type::f32);
      in.results.push_back(slope);
    }
    set(result, made);
  }

  void walk(Region& region) {
    std::vector<Instruction> out;
    out.reserve(region.body.size() * 3);
    for (Instruction& in : region.body) visit(in, out);
    region.body = std::move(out);
  }

  void visit(Instruction& in, std::vector<Instruction>& out) {
    const Emit emit(function_, out);
    switch (in.op) {
      case Op::if_:
        return branch(in, out);
      case Op::loop:
        return turn(in, out);
      case Op::call:
        return call(in, out);
      case Op::external:
        return external(in, out);
      case Op::array_store:
      case Op::array_resize:
      case Op::array_load:
        return array(in, out);
      default:
        break;
    }
    out.push_back(in);
    if (in.results.size() != 1) return;
    if (in.op == Op::input) {
      if (!is_active(in.result())) return;
      Slopes made = none;
      for (std::size_t k = 0; k < directions; ++k)
        if (const std::int32_t slope = all_.slope_inputs(in.imm)[k]; slope != all_.no_input)
          made[k] = emit(Op::input, {}, slope);
      return set(in.result(), made);
    }
    if (is_active(in.result())) {
      Slopes made = none;
      for (std::size_t k = 0; k < directions; ++k) {
        std::vector<Value> operands;
        for (const Value operand : in.operands) operands.push_back(slopes(operand)[k]);
        if (std::ranges::any_of(operands, [](Value slope) { return slope != no_value; }))
          made[k] = slope_of(emit, in, operands);
      }
      set(in.result(), made);
    }
    if (decisions_) see_edges(emit, in);
  }

  // The edges that a decision makes.
  void see_edges(const Emit& emit, const Instruction& in) {
    const Value result = in.result();
    if (result >= decisions_->forks.size() ||
        (!decisions_->forks[result] && !decisions_->bends[result]))
      return;
    const Value a = in.operands[0];
    const Cut cut = cut_of(in.op);
    const bool between = in.operands.size() == 2;
    if (!is_active(a) && !(between && is_active(in.operands[1]))) return;
    Slopes slope = present(emit, a);
    if (cut == Cut::compare || (cut == Cut::kink && between)) {
      const Slopes other = slopes(in.operands[1]);
      for (std::size_t k = 0; k < directions; ++k)
        if (other[k] != no_value) slope[k] = emit.sub(slope[k], other[k]);
      edges_ = see_edge(emit, *edges_, emit.sub(a, in.operands[1]), slope[0], slope[1]);
    } else if (cut == Cut::kink) {
      edges_ = see_edge(emit, *edges_, a, slope[0], slope[1]);
    } else {
      // The steps below and above.
      const Value shifted = cut == Cut::half ? emit.sub(a, emit.number(0.5f)) : a;
      const Value above = emit.sub(shifted, emit(Op::ffloor, {shifted}));
      edges_ = see_edge(emit, *edges_, above, slope[0], slope[1]);
      edges_ = see_edge(emit, *edges_, emit.sub(above, emit.number(1)), slope[0], slope[1]);
    }
  }

  void branch(Instruction& in, std::vector<Instruction>& out) {
    const std::optional<EdgeState> before = edges_;
    std::array<std::optional<EdgeState>, 2> after;
    for (std::size_t side = 0; side < 2; ++side) {
      edges_ = before;
      walk(in.regions[side]);
      after[side] = edges_;
    }
    edges_ = before;
    const std::size_t count = in.results.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_active(in.results[i])) continue;
      for (Region& region : in.regions)
        for (const Value slope : present(Emit(function_, region.body), region.yields[i]))
          region.yields.push_back(slope);
      add_slope_results(in, in.results[i]);
    }
    if (before && (after[0] != before || after[1] != before)) {
      for (std::size_t k = 0; k < before->size(); ++k) {
        for (std::size_t side = 0; side < 2; ++side)
          in.regions[side].yields.push_back((*after[side])[k]);
        in.results.push_back(function_.add_value(ir::Type::f32));
        (*edges_)[k] = in.results.back();
      }
    }
    out.push_back(std::move(in));
  }

  // The head decides only: its own edges were copied behind and into the loop (rotate.h).
  void turn(Instruction& in, std::vector<Instruction>& out) {
    Region &head = in.regions[0], &body = in.regions[1];
    const std::size_t count = in.results.size();
    const Emit outside(function_, out);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_active(in.results[i])) continue;
      for (const Value slope : present(outside, in.operands[i])) in.operands.push_back(slope);
      add_slope_params(head, head.params[i]);
      add_slope_params(body, body.params[i]);
    }
    if (edges_) {
      for (Value& part : *edges_) {
        in.operands.push_back(part);
        head.params.push_back(function_.add_value(ir::Type::f32));
        part = function_.add_value(ir::Type::f32);
        body.params.push_back(part);
      }
    }
    walk(body);
    const Emit within(function_, body.body);
    for (std::size_t i = 0; i < count; ++i)
      if (is_active(in.results[i])) {
        for (const Value slope : present(within, body.yields[i])) body.yields.push_back(slope);
        add_slope_results(in, in.results[i]);
      }
    if (edges_) {
      for (Value& part : *edges_) {
        body.yields.push_back(part);
        part = function_.add_value(ir::Type::f32);
        in.results.push_back(part);
      }
    }
    out.push_back(std::move(in));
  }

  void call(Instruction& in, std::vector<Instruction>& out) {
    std::vector<bool> with;
    for (const Value operand : in.operands) with.push_back(slopes(operand) != none);
    if (std::ranges::find(with, true) == with.end()) return out.push_back(std::move(in));
    const Emit emit(function_, out);
    const auto callee = static_cast<std::uint32_t>(in.imm);
    const std::string& name = all_.module.functions[callee].name;
    if (has_partials(name)) {
      out.push_back(in);
      const std::vector<Value> partials = *partials_of(emit, name, in, with);
      Slopes made = none;
      for (std::size_t k = 0; k < directions; ++k)
        for (std::size_t i = 0; i < with.size(); ++i) {
          const Value slope = slopes(in.operands[i])[k];
          if (!with[i] || slope == no_value) continue;
          const Value part = emit.mul(partials[i], slope);
          made[k] = made[k] == no_value ? part : emit.add(made[k], part);
        }
      return set(in.result(), made);
    }
    const Active& active = all_.active(callee, with);
    const std::vector<Value> operands = in.operands, results = in.results;
    std::vector<Directions> changing(operands.size());
    for (std::size_t i = 0; i < operands.size(); ++i)
      for (std::size_t k = 0; k < directions; ++k)
        if (const Value slope = slopes(operands[i])[k]; slope != no_value) {
          changing[i][k] = true;
          in.operands.push_back(slope);
        }
    in.imm = static_cast<std::int32_t>(all_.derived(callee, changing));
    for (std::size_t i = 0; i < results.size(); ++i)
      if (active.results[i]) add_slope_results(in, results[i]);
    out.push_back(std::move(in));
  }

  // A function of the host is asked one pixel further, to the right and down.
  void external(Instruction& in, std::vector<Instruction>& out) {
    bool any = false;
    for (const Value operand : in.operands) any = any || is_active(operand);
    out.push_back(in);
    if (!any) return;
    const Emit emit(function_, out);
    std::vector<Slopes> made(in.results.size());
    for (std::size_t k = 0; k < directions; ++k) {
      Instruction moved{.op = Op::external, .imm = in.imm, .span = in.span};
      for (const Value operand : in.operands)
        moved.operands.push_back(
            slopes(operand)[k] != no_value ? emit.add(operand, slopes(operand)[k]) : operand);
      for (std::size_t i = 0; i < in.results.size(); ++i)
        moved.results.push_back(function_.add_value(ir::Type::f32));
      const std::vector<Value> there = moved.results;
      out.push_back(std::move(moved));
      for (std::size_t i = 0; i < made.size(); ++i) made[i][k] = emit.sub(there[i], in.results[i]);
    }
    for (std::size_t i = 0; i < made.size(); ++i) set(in.results[i], made[i]);
  }

  void array(Instruction& in, std::vector<Instruction>& out) {
    const Emit emit(function_, out);
    const std::int32_t shadow = shadow_[static_cast<std::size_t>(in.imm)];
    out.push_back(in);
    if (shadow < 0) return;
    if (in.op == Op::array_resize) {
      for (std::int32_t k = 0; k < 2; ++k) emit.effect(in.op, {in.operands[0]}, shadow + k);
    } else if (in.op == Op::array_store) {
      const Slopes slope = present(emit, in.operands[1]);
      for (std::int32_t k = 0; k < 2; ++k)
        emit.effect(in.op, {in.operands[0], slope[static_cast<std::size_t>(k)]}, shadow + k,
                    in.component);
    } else if (is_active(in.result())) {
      set(in.result(), {emit(in.op, {in.operands[0]}, shadow, in.component),
                        emit(in.op, {in.operands[0]}, shadow + 1, in.component)});
    }
  }

  ModuleDeriver& all_;
  Function& function_;
  const Active& active_;
  const Decisions* decisions_;
  std::vector<Slopes> slopes_;
  std::vector<std::int32_t> shadow_;  // per array: the first of its two arrays of slopes
  std::optional<EdgeState> edges_;
};

std::uint32_t ModuleDeriver::derived(std::uint32_t function,
                                     const std::vector<Directions>& parameters) {
  const auto key = std::pair(function, parameters);
  if (const auto found = derived_.find(key); found != derived_.end()) return found->second;
  Function copy = module.functions[function];
  copy.name += "'";
  std::vector<bool> any;
  for (const Directions& changing : parameters) any.push_back(changing[0] || changing[1]);
  FunctionDeriver deriver(*this, copy, active(function, any), nullptr);
  deriver.run(parameters);
  deriver.yield_slopes(false);
  module.functions.push_back(std::move(copy));
  return derived_[key] = static_cast<std::uint32_t>(module.functions.size() - 1);
}

}  // namespace

void derive_edges(ir::Module& module, const Decisions& found, const InputChanges& changes) {
  Decisions decisions = found;
  rotate_loops(module.main(), decisions);
  ModuleDeriver all(module, changes);
  Function main = module.main();
  FunctionDeriver deriver(all, main, all.active(module.entry, {}), &decisions);
  deriver.run({});
  module.outputs.clear();
  for (const char* line : {"$first", "$second"})
    for (const char* part : {".distance", ".nx", ".ny"})
      module.outputs.push_back({std::string(line) + part});
  main.body.yields.assign(deriver.edges().begin(), deriver.edges().end());
  module.main() = std::move(main);
}

void derive_outputs(ir::Module& module, const InputChanges& changes) {
  ModuleDeriver all(module, changes);
  Function main = module.main();
  FunctionDeriver deriver(all, main, all.active(module.entry, {}), nullptr);
  deriver.run({});
  deriver.yield_slopes(true);
  const std::vector<ir::Output> outputs = module.outputs;
  for (const ir::Output& output : outputs) {
    module.outputs.push_back({output.name + "$x"});
    module.outputs.push_back({output.name + "$y"});
  }
  module.main() = std::move(main);
}

}  // namespace pse::antialias
