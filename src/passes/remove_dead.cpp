// Dead code: marks what outputs and effects need, then drops the rest. Loop parameters are marked
// one by one, so a counter that feeds only itself goes too.
#include <algorithm>
#include <utility>

#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class DeadCode {
 public:
  explicit DeadCode(Function& function)
      : function_(function),
        definitions_(function.values.size()),
        live_(function.values.size(), false),
        array_use_(function.arrays.size(), 0),
        writers_(function.arrays.size()) {}

  void run(const std::vector<bool>& observed) {
    find_definitions(function_.body, nowhere);
    for (const Value value : function_.body.yields) mark(value);
    for (const Writer& effect : effects_) mark_effect(effect);
    for (std::size_t i = 0; i < observed.size() && i < array_use_.size(); ++i) {
      if (observed[i]) mark_array(i, true);
    }
    propagate();
    sweep(function_.body);
  }

  bool array_is_used(std::size_t array) const { return array_use_[array] != 0; }

 private:
  static constexpr std::uint32_t nowhere = 0xffffffffu;

  // An instruction with regions, or one with an effect, and the instruction whose region it is in.
  struct Writer {
    const Instruction* in;
    std::uint32_t parent;
  };
  // Where a value comes from: an instruction's result, or the k-th thing that a loop carries.
  struct Definition {
    const Instruction* in = nullptr;
    std::uint32_t container =
        nowhere;  // index into containers_, for results of ifs and loops and loops' parameters
    std::uint32_t index = 0;
  };
  struct Container {
    const Instruction* in;
    std::uint32_t parent;
    bool live = false;
  };

  void find_definitions(const Region& region, std::uint32_t parent) {
    for (const Instruction& in : region.body) {
      std::uint32_t container = nowhere;
      if (has_regions(in.op)) {
        container = static_cast<std::uint32_t>(containers_.size());
        containers_.push_back({&in, parent});
        if (in.op == Op::loop)
          define(in.regions[0].params, in, container), define(in.regions[1].params, in, container);
        for (const Region& inner : in.regions) find_definitions(inner, container);
      }
      define(in.results, in, container);
      if (is_effect(in)) effects_.push_back({&in, parent});
      if (writes_array(in.op)) writers_[static_cast<std::size_t>(in.imm)].push_back({&in, parent});
    }
  }

  void define(const std::vector<Value>& values, const Instruction& in, std::uint32_t container) {
    for (std::uint32_t i = 0; i < values.size(); ++i) definitions_[values[i]] = {&in, container, i};
  }

  void mark(Value value) {
    if (live_[value]) return;
    live_[value] = true;
    work_.push_back(value);
  }

  // An effect needs its operands, and the ifs and loops around it.
  void mark_effect(const Writer& effect) {
    for (const Value operand : effect.in->operands) mark(operand);
    mark_container(effect.parent);
  }

  void mark_container(std::uint32_t container) {
    while (container != nowhere && !containers_[container].live) {
      containers_[container].live = true;
      const Instruction& in = *containers_[container].in;
      mark(in.op == Op::if_ ? in.operands[0] : in.regions[0].yields[0]);
      container = containers_[container].parent;
    }
  }

  // A load needs all writes of its array; a length needs only what sets lengths.
  void mark_array(std::size_t array, bool elements) {
    const std::uint8_t wanted = elements ? 2 : 1;
    if (array_use_[array] >= wanted) return;
    const std::uint8_t had = std::exchange(array_use_[array], wanted);
    for (const Writer& writer : writers_[array]) {
      const bool sets_length = writer.in->op == Op::array_resize;
      if (sets_length ? had == 0 : elements) mark_effect(writer);
    }
  }

  void propagate() {
    while (!work_.empty()) {
      const Definition definition = definitions_[work_.back()];
      work_.pop_back();
      if (!definition.in) continue;  // a parameter of the function
      const Instruction& in = *definition.in;
      if (in.op == Op::if_) {
        for (const Region& region : in.regions) mark(region.yields[definition.index]);
        mark_container(definition.container);
      } else if (in.op == Op::loop) {
        mark(in.operands[definition.index]);
        mark(in.results[definition.index]);
        mark(in.regions[1].yields[definition.index]);
        mark_container(definition.container);
      } else {
        for (const Value operand : in.operands) mark(operand);
        if (reads_array(in.op))
          mark_array(static_cast<std::size_t>(in.imm), in.op == Op::array_load);
      }
    }
  }

  // Containers are met again in the order in which they were numbered.
  void sweep(Region& region) {
    std::vector<Instruction> kept;
    kept.reserve(region.body.size());
    for (Instruction& in : region.body) {
      if (has_regions(in.op)) {
        const bool live = containers_[next_container_++].live;
        if (live) {
          sweep_container(in);
          kept.push_back(std::move(in));
        } else {
          for (const Region& inner : in.regions) skip(inner);
        }
      } else if (is_needed(in)) {
        kept.push_back(std::move(in));
      }
    }
    region.body = std::move(kept);
  }

  void skip(const Region& region) {
    for (const Instruction& in : region.body) {
      if (!has_regions(in.op)) continue;
      ++next_container_;
      for (const Region& inner : in.regions) skip(inner);
    }
  }

  bool is_needed(const Instruction& in) const {
    if (is_effect(in)) return true;
    const auto array = static_cast<std::size_t>(in.imm);
    if (in.op == Op::array_store) return array_use_[array] == 2;
    if (in.op == Op::array_resize) return array_use_[array] > 0;
    return std::ranges::any_of(in.results, [&](Value value) { return live_[value]; });
  }

  void sweep_container(Instruction& in) {
    // Whether the k-th result is kept; a loop's parameter and result live and die together.
    const std::size_t count = in.results.size();
    std::vector<bool> keep(count);
    for (std::size_t i = 0; i < count; ++i) keep[i] = live_[in.results[i]];
    const auto cut = [&](std::vector<Value>& values) {
      std::size_t next = 0;
      for (std::size_t i = 0; i < count; ++i) {
        if (keep[i]) values[next++] = values[i];
      }
      values.resize(next);
    };
    cut(in.results);
    cut(in.regions[1].yields);
    if (in.op == Op::if_) {
      cut(in.regions[0].yields);
    } else {
      cut(in.operands);
      cut(in.regions[0].params);
      cut(in.regions[1].params);
    }
    for (Region& region : in.regions) sweep(region);
  }

  Function& function_;
  std::vector<Definition> definitions_;
  std::vector<bool> live_;
  std::vector<std::uint8_t> array_use_;  // 0: unused, 1: its length is read, 2: its elements are
  std::vector<std::vector<Writer>> writers_;  // per array
  std::vector<Writer> effects_;               // checks, and reports to the host
  std::vector<Container> containers_;  // in order of appearance
  std::size_t next_container_ = 0;
  std::vector<Value> work_;
};

template <typename Visit>
void for_each_instruction(Region& region, const Visit& visit) {
  for (Instruction& in : region.body) {
    visit(in);
    for (Region& inner : in.regions) for_each_instruction(inner, visit);
  }
}

void remove_arrays(Function& function, const DeadCode& dead) {
  std::vector<std::int32_t> number(function.arrays.size(), -1);
  std::vector<ir::Array> kept;
  for (std::size_t i = 0; i < function.arrays.size(); ++i) {
    if (!dead.array_is_used(i)) continue;
    number[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(std::move(function.arrays[i]));
  }
  if (kept.size() == function.arrays.size()) {
    function.arrays = std::move(kept);
    return;
  }
  function.arrays = std::move(kept);
  for_each_instruction(function.body, [&](Instruction& in) {
    if (reads_array(in.op) || writes_array(in.op))
      in.imm = number[static_cast<std::size_t>(in.imm)];
  });
}

// Functions that the entry does not reach go, and the others are numbered anew.
void remove_functions(ir::Module& module) {
  std::vector<bool> reached(module.functions.size(), false);
  std::vector<std::size_t> work = {module.entry};
  reached[module.entry] = true;
  while (!work.empty()) {
    Region& body = module.functions[work.back()].body;
    work.pop_back();
    for_each_instruction(body, [&](const Instruction& in) {
      const auto callee = static_cast<std::size_t>(in.imm);
      if (in.op != Op::call || reached[callee]) return;
      reached[callee] = true;
      work.push_back(callee);
    });
  }
  if (std::ranges::all_of(reached, [](bool r) { return r; })) return;

  std::vector<std::int32_t> number(module.functions.size(), -1);
  decltype(module.functions) kept;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) continue;
    number[i] = static_cast<std::int32_t>(kept.size());
    kept.push_back(std::move(module.functions[i]));
  }
  module.functions = std::move(kept);
  module.entry = static_cast<std::uint32_t>(number[module.entry]);
  for (Function& function : module.functions) {
    for_each_instruction(function.body, [&](Instruction& in) {
      if (in.op == Op::call) in.imm = number[static_cast<std::size_t>(in.imm)];
    });
  }
}

}  // namespace

void remove_dead(ir::Module& module, const DeadOptions& options) {
  for (Function& function : module.functions) {
    DeadCode dead(function);
    dead.run(options.observed);
    if (options.arrays && !function.arrays.empty()) remove_arrays(function, dead);
  }
  if (options.functions) remove_functions(module);
}

}  // namespace pse::passes
