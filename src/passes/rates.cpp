// Rates: how often each value changes (1985: `if begin_frame` is the frame rate made visible). The
// lowest rates that are consistent are found by raising them until nothing changes; each value
// rises at most twice.
//
// Within a loop the rate of a value says that it is the same for all samples in the same turn.
#include <algorithm>
#include <utility>

#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Rate;
using ir::Region;
using ir::Value;

constexpr std::uint32_t nowhere = 0xffffffffu;

class RateAssigner {
 public:
  RateAssigner(const ir::Module& module, Function& function, std::vector<bool>& of_sample,
               const std::vector<bool>& asks_external)
      : module_(module),
        function_(function),
        of_sample_(of_sample),
        asks_external_(asks_external),
        users_(function.values.size() + 1, 0),
        readers_(function.arrays.size()) {
    of_sample_.resize(function.arrays.size(), false);
  }

  void run() {
    for (ir::ValueInfo& value : function_.values) value.rate = Rate::constant;
    for (const Value param : function_.body.params) function_.values[param].rate = Rate::sample;
    collect(function_.body, nowhere);
    index_users();
    for (std::uint32_t i = 0; i < instructions_.size(); ++i) work_.push_back(i);
    std::ranges::reverse(work_);
    while (!work_.empty()) {
      const std::uint32_t index = work_.back();
      work_.pop_back();
      queued_[index] = false;
      update(index);
    }
    for (std::size_t i = 0; i < function_.arrays.size(); ++i) {
      function_.arrays[i].rate = of_sample_[i] ? Rate::sample : Rate::frame;
    }
  }

 private:
  // An instruction, the if or loop that it stands in, and whether it runs only for some samples.
  struct Place {
    const Instruction* in;
    std::uint32_t parent;
    bool of_sample = false;  // ifs and loops: their regions run differently from sample to sample
    // Ifs and loops: those within that must know, and writes of arrays.
    std::vector<std::uint32_t> inner;
  };

  void collect(const Region& region, std::uint32_t parent) {
    for (const Instruction& in : region.body) {
      const auto index = static_cast<std::uint32_t>(instructions_.size());
      instructions_.push_back({&in, parent, false, {}});
      queued_.push_back(true);
      if (parent != nowhere && (has_regions(in.op) || writes_array(in.op))) {
        instructions_[parent].inner.push_back(index);
      }
      if (reads_array(in.op)) readers_[static_cast<std::size_t>(in.imm)].push_back(index);
      for (const Region& inner : in.regions) collect(inner, index);
    }
  }

  template <typename Visit>
  static void for_each_use(const Instruction& in, const Visit& visit) {
    for (const Value operand : in.operands) visit(operand);
    for (const Region& region : in.regions) {
      for (const Value value : region.yields) visit(value);
    }
  }

  // users_of_ holds the users of value v from users_[v] to users_[v + 1].
  void index_users() {
    for (const Place& place : instructions_)
      for_each_use(*place.in, [&](Value value) { ++users_[value + 1]; });
    for (std::size_t i = 1; i < users_.size(); ++i) users_[i] += users_[i - 1];
    users_of_.resize(users_.back());
    std::vector<std::uint32_t> next(users_.begin(), users_.end() - 1);
    for (std::uint32_t i = 0; i < instructions_.size(); ++i) {
      for_each_use(*instructions_[i].in, [&](Value value) { users_of_[next[value]++] = i; });
    }
  }

  void queue(std::uint32_t index) {
    if (queued_[index]) return;
    queued_[index] = true;
    work_.push_back(index);
  }

  Rate rate(Value value) const { return function_.values[value].rate; }

  void raise(Value value, Rate to) {
    if (rate(value) >= to) return;
    function_.values[value].rate = to;
    for (std::uint32_t i = users_[value]; i < users_[value + 1]; ++i) queue(users_of_[i]);
  }

  void update(std::uint32_t index) {
    const Instruction& in = *instructions_[index].in;
    if (in.op == Op::if_) return update_if(index);
    if (in.op == Op::loop) return update_loop(index);
    Rate highest = Rate::constant;
    for (const Value operand : in.operands) highest = std::max(highest, rate(operand));
    const auto imm = static_cast<std::size_t>(in.imm);
    if (in.op == Op::input) highest = module_.inputs[imm].rate;
    // Until passes/slopes has put the derivative in its place: what goes by the pixel's width
    // alone, such as how many octaves are summed, is no edge of the picture.
    if (in.op == Op::slope) highest = std::min(highest, Rate::frame);
    // What the host brings may be another thing in another frame, and so may what is in memory.
    const bool asks = in.op == Op::external || (in.op == Op::call && asks_external_[imm]);
    if (asks || reads_array(in.op)) highest = std::max(highest, Rate::frame);
    if (reads_array(in.op) && of_sample_[imm]) highest = Rate::sample;
    if (writes_array(in.op) && (highest == Rate::sample || runs_for_some(index))) raise_array(imm);
    for (const Value result : in.results) raise(result, highest);
  }

  bool runs_for_some(std::uint32_t index) const {
    const std::uint32_t parent = instructions_[index].parent;
    return parent != nowhere && instructions_[parent].of_sample;
  }

  void raise_array(std::size_t array) {
    if (of_sample_[array]) return;
    of_sample_[array] = true;
    for (const std::uint32_t reader : readers_[array]) queue(reader);
  }

  void update_if(std::uint32_t index) {
    const Instruction& in = *instructions_[index].in;
    const Rate condition = rate(in.operands[0]);
    spread_control(index, condition);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      raise(in.results[i],
            std::max({condition, rate(in.regions[0].yields[i]), rate(in.regions[1].yields[i])}));
    }
  }

  void update_loop(std::uint32_t index) {
    const Instruction& in = *instructions_[index].in;
    const Region& head = in.regions[0];
    const Region& body = in.regions[1];
    for (std::size_t i = 0; i < in.operands.size(); ++i) {
      const Rate carried = std::max(rate(in.operands[i]), rate(body.yields[i]));
      raise(head.params[i], carried);
      raise(body.params[i], carried);
    }
    const Rate condition = rate(head.yields[0]);
    spread_control(index, condition);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      raise(in.results[i], std::max(condition, rate(head.params[i])));
    }
  }

  // What stands in an if or a loop that differs from sample to sample is told so, once.
  void spread_control(std::uint32_t index, Rate condition) {
    Place& place = instructions_[index];
    if (place.of_sample || (condition != Rate::sample && !runs_for_some(index))) return;
    place.of_sample = true;
    for (const std::uint32_t inner : place.inner) queue(inner);
  }

  const ir::Module& module_;
  Function& function_;
  std::vector<bool>& of_sample_;
  const std::vector<bool>& asks_external_;
  std::vector<Place> instructions_;
  std::vector<std::uint32_t> users_;
  std::vector<std::uint32_t> users_of_;
  std::vector<std::vector<std::uint32_t>> readers_;  // per array
  std::vector<bool> queued_;
  std::vector<std::uint32_t> work_;
};

bool asks_external(const ir::Module& module, const Region& region, std::vector<std::int8_t>& known);

bool asks_external(const ir::Module& module, std::size_t function,
                   std::vector<std::int8_t>& known) {
  if (known[function] < 0)
    known[function] = asks_external(module, module.functions[function].body, known);
  return known[function] != 0;
}

bool asks_external(const ir::Module& module, const Region& region,
                   std::vector<std::int8_t>& known) {
  return std::ranges::any_of(region.body, [&](const Instruction& in) {
    if (in.op == Op::external) return true;
    if (in.op == Op::call && asks_external(module, static_cast<std::size_t>(in.imm), known))
      return true;
    return std::ranges::any_of(
        in.regions, [&](const Region& inner) { return asks_external(module, inner, known); });
  });
}

std::vector<bool> functions_that_ask(const ir::Module& module) {
  std::vector<std::int8_t> known(module.functions.size(), -1);
  std::vector<bool> asks;
  for (std::size_t i = 0; i < known.size(); ++i) asks.push_back(asks_external(module, i, known));
  return asks;
}

}  // namespace

void assign_rates(const ir::Module& module, Function& function, std::vector<bool>& of_sample) {
  RateAssigner(module, function, of_sample, functions_that_ask(module)).run();
}

void assign_rates(ir::Module& module) {
  const std::vector<bool> asks = functions_that_ask(module);
  for (Function& function : module.functions) {
    std::vector<bool> of_sample;
    RateAssigner(module, function, of_sample, asks).run();
  }
}

}  // namespace pse::passes
