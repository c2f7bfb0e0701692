// One function after the other, region by region: each instruction is followed by those of its
// slopes. Functions are derived once for each set of arguments that have slopes.
#include "passes/deriver.h"

#include <algorithm>
#include <map>

#include "passes/activity.h"
#include "passes/rewrite.h"
#include "passes/slope_rules.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Region;
using ir::Value;

constexpr std::size_t directions = 2;
constexpr Slopes none = {no_value, no_value};
using Directions = std::array<bool, directions>;  // in which a value changes

class ModuleDeriver {
 public:
  ModuleDeriver(ir::Module& m, const std::vector<SlopesOfInput>& inputs)
      : module(m), activity_(m, active_inputs(inputs)) {
    const auto input = [&](const std::string& name, ir::Rate rate) {
      const auto found = std::ranges::find(module.inputs, name, &ir::Input::name);
      if (found != module.inputs.end())
        return static_cast<std::int32_t>(found - module.inputs.begin());
      module.inputs.push_back({name, rate});
      return static_cast<std::int32_t>(module.inputs.size() - 1);
    };
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      slope_inputs_.push_back({no_input, no_input});
      for (std::size_t d = 0; d < directions; ++d) {
        if (inputs[k][d] == InputSlopes::none) continue;
        slope_inputs_.back()[d] =
            input(module.inputs[k].name + (d == 0 ? "$x" : "$y"),
                  inputs[k][d] == InputSlopes::of_frame ? ir::Rate::frame : ir::Rate::sample);
      }
    }
  }

  const Active& active(std::uint32_t function, const std::vector<bool>& parameters) {
    return activity_.of(function, parameters);
  }
  static constexpr std::int32_t no_input = -1;
  // The inputs that are the slopes of an input; no_input where it does not change.
  const std::array<std::int32_t, directions>& slope_inputs(std::int32_t input) const {
    return slope_inputs_[static_cast<std::size_t>(input)];
  }
  // The function that gives the results and their slopes: parameters, then those slopes of each
  // that are not 0; results, then two slopes for each that has any.
  std::uint32_t derived(std::uint32_t function, const std::vector<Directions>& parameters);

  ir::Module& module;

 private:
  static std::vector<bool> active_inputs(const std::vector<SlopesOfInput>& inputs) {
    std::vector<bool> active;
    for (const SlopesOfInput& slopes : inputs)
      active.push_back(slopes[0] != InputSlopes::none || slopes[1] != InputSlopes::none);
    return active;
  }

  Activity activity_;
  std::vector<std::array<std::int32_t, directions>> slope_inputs_;
  std::map<std::pair<std::uint32_t, std::vector<Directions>>, std::uint32_t> derived_;
};

class FunctionDeriver {
 public:
  FunctionDeriver(ModuleDeriver& all, Function& function, const Active& active, Watcher* watcher)
      : all_(all),
        function_(function),
        active_(active),
        watcher_(watcher),
        has_questions_(asks_for_slopes(function.body)),
        slopes_(function.values.size(), none),
        replaced_(function.values.size()),
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
    if (watcher_) carried_ = watcher_->start(Emit(function_, start));
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

  const std::vector<Value>& carried() const { return carried_; }

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
    replaced_.apply(region.yields);
  }

  void visit(Instruction& in, std::vector<Instruction>& out) {
    const Emit emit(function_, out);
    replaced_.apply(in.operands);
    switch (in.op) {
      case Op::slope: {
        // What was asked for takes the place of the question.
        const Value found = slopes(in.operands[0])[static_cast<std::size_t>(in.imm)];
        return replaced_.set(in.result(), found == no_value ? emit.number(0) : found);
      }
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
    if (watcher_ && watching_)
      watcher_->see(
          emit, in, [&](Value value) { return slopes(value); }, carried_);
  }

  void branch(Instruction& in, std::vector<Instruction>& out) {
    const std::vector<Value> before = carried_;
    std::array<std::vector<Value>, 2> after;
    for (std::size_t side = 0; side < 2; ++side) {
      carried_ = before;
      walk(in.regions[side]);
      after[side] = carried_;
    }
    carried_ = before;
    const std::size_t count = in.results.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_active(in.results[i])) continue;
      for (Region& region : in.regions)
        for (const Value slope : present(Emit(function_, region.body), region.yields[i]))
          region.yields.push_back(slope);
      add_slope_results(in, in.results[i]);
    }
    if (after[0] != before || after[1] != before) {
      for (std::size_t k = 0; k < before.size(); ++k) {
        for (std::size_t side = 0; side < 2; ++side)
          in.regions[side].yields.push_back(after[side][k]);
        in.results.push_back(function_.add_value(ir::Type::f32));
        carried_[k] = in.results.back();
      }
    }
    out.push_back(std::move(in));
  }

  // The watcher sees nothing of the head, whose values nothing behind it can use.
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
    for (Value& value : carried_) {
      in.operands.push_back(value);
      head.params.push_back(function_.add_value(ir::Type::f32));
      value = function_.add_value(ir::Type::f32);
      body.params.push_back(value);
    }
    if (has_questions_) {
      watching_ = false;
      walk(head);
      watching_ = true;
    }
    walk(body);
    const Emit within(function_, body.body);
    for (std::size_t i = 0; i < count; ++i)
      if (is_active(in.results[i])) {
        for (const Value slope : present(within, body.yields[i])) body.yields.push_back(slope);
        add_slope_results(in, in.results[i]);
      }
    for (Value& value : carried_) {
      body.yields.push_back(value);
      value = function_.add_value(ir::Type::f32);
      in.results.push_back(value);
    }
    out.push_back(std::move(in));
  }

  void call(Instruction& in, std::vector<Instruction>& out) {
    std::vector<bool> with;
    for (const Value operand : in.operands) with.push_back(slopes(operand) != none);
    const bool wanted =
        std::ranges::any_of(in.results, [&](Value value) { return is_active(value); });
    if (!wanted || std::ranges::find(with, true) == with.end()) return out.push_back(std::move(in));
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
    const bool wanted =
        std::ranges::any_of(in.results, [&](Value value) { return is_active(value); });
    out.push_back(in);
    if (!any || !wanted) return;
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
  Watcher* watcher_;
  bool has_questions_, watching_ = true;
  std::vector<Slopes> slopes_;
  Renaming replaced_;
  std::vector<std::int32_t> shadow_;  // per array: the first of its two arrays of slopes
  std::vector<Value> carried_;
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

bool asks_for_slopes(const Region& region) {
  return std::ranges::any_of(region.body, [](const Instruction& in) {
    return in.op == Op::slope || std::ranges::any_of(in.regions, asks_for_slopes);
  });
}

std::vector<Value> derive_main(ir::Module& module, const std::vector<SlopesOfInput>& inputs,
                               const Derivation& how) {
  ModuleDeriver all(module, inputs);
  Function main = module.main();
  // With fewer values to follow, where that is known.
  Active active = all.active(module.entry, {});
  if (how.needed) {
    for (std::size_t v = 0; v < active.values.size(); ++v)
      active.values[v] = active.values[v] && (*how.needed)[static_cast<Value>(v)];
    for (std::size_t a = 0; a < active.arrays.size(); ++a)
      active.arrays[a] = active.arrays[a] && how.needed->has_array(a);
  }
  FunctionDeriver deriver(all, main, active, how.watcher);
  deriver.run({});
  if (how.yield_slopes) deriver.yield_slopes(true);
  module.main() = std::move(main);
  return deriver.carried();
}

}  // namespace pse::passes
