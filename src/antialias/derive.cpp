// The edges as what a derivation carries along, and where decisions put them.
#include "antialias/derive.h"

#include <algorithm>

#include "antialias/edge_state.h"
#include "antialias/roots.h"
#include "antialias/rotate.h"
#include "antialias/searches.h"
#include "passes/deriver.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Value;
using passes::Emit;
using passes::InputSlopes;
using passes::Slopes;

class EdgeWatcher : public passes::Watcher {
 public:
  EdgeWatcher(const Decisions& decisions, Roots roots)
      : decisions_(decisions), roots_(std::move(roots)) {}

  std::vector<Value> start(const Emit& emit) override {
    const EdgeState edges = start_edges(emit);
    return {edges.begin(), edges.end()};
  }

  // The edges that a decision makes.
  void see(const Emit& emit, const Instruction& in, const SlopesOf& slopes_of,
           std::vector<Value>& carried) override {
    const Value result = in.result();
    if (result >= decisions_.forks.size() ||
        (!decisions_.forks[result] && !decisions_.bends[result]))
      return;
    const bool between = in.operands.size() == 2;
    const Roots::Sides sides =
        between && cut_of(in.op) == Cut::compare
            ? roots_.under(emit, {in.operands[0], in.operands[1]})
            : Roots::Sides{in.operands[0], between ? in.operands[1] : no_value};
    const Value a = sides.a;
    const Slopes of_a = slopes_of(a);
    const Slopes of_b = between ? slopes_of(sides.b) : Slopes{no_value, no_value};
    const Slopes none = {no_value, no_value};
    if (of_a == none && of_b == none) return;

    EdgeState edges{};
    std::ranges::copy(carried, edges.begin());
    const auto present = [&](Value slope) { return slope == no_value ? emit.number(0) : slope; };
    Slopes slope = {present(of_a[0]), present(of_a[1])};
    const Cut cut = cut_of(in.op);
    if (cut == Cut::compare || (cut == Cut::kink && between)) {
      for (std::size_t k = 0; k < slope.size(); ++k)
        if (of_b[k] != no_value) slope[k] = emit.sub(slope[k], of_b[k]);
      edges = see_edge(emit, edges, emit.sub(a, sides.b), slope[0], slope[1]);
    } else if (cut == Cut::kink) {
      edges = see_edge(emit, edges, a, slope[0], slope[1]);
    } else {
      // The steps below and above.
      const Value shifted = cut == Cut::half ? emit.sub(a, emit.number(0.5f)) : a;
      const Value above = emit.sub(shifted, emit(Op::ffloor, {shifted}));
      edges = see_edge(emit, edges, above, slope[0], slope[1]);
      edges = see_edge(emit, edges, emit.sub(above, emit.number(1)), slope[0], slope[1]);
    }
    std::ranges::copy(edges, carried.begin());
  }

 private:
  const Decisions& decisions_;
  const Roots roots_;
};

// Every input of the samples has slopes, unless it is known not to.
std::vector<passes::SlopesOfInput> slopes_of_inputs(const ir::Module& module,
                                                    const InputChanges& changes) {
  const auto slopes = [](Change change) {
    return change == Change::none   ? InputSlopes::none
           : change == Change::even ? InputSlopes::of_frame
                                    : InputSlopes::of_sample;
  };
  std::vector<passes::SlopesOfInput> inputs;
  for (const ir::Input& input : module.inputs) {
    inputs.push_back({InputSlopes::none, InputSlopes::none});
    if (input.rate != ir::Rate::sample) continue;
    const auto [along_x, along_y] = changes(input.name);
    inputs.back() = {slopes(along_x), slopes(along_y)};
  }
  return inputs;
}

// Quotients by what is 0 for the frame, as of a smoothstep without width, become steep instead of
// infinite: an edge's place is the same, and it has a slope.
void widen_steps(ir::Function& function, ir::Region& region) {
  constexpr float least = 1e-12f;
  std::vector<Instruction> out;
  for (Instruction& in : region.body) {
    for (ir::Region& inner : in.regions) widen_steps(function, inner);
    if (in.op == Op::fdiv && function.values[in.operands[1]].rate != ir::Rate::sample) {
      const Emit emit(function, out);
      const Value by = in.operands[1];
      const Value is_zero = emit(Op::feq, {by, emit.number(0)});
      in.operands[1] = emit.choose(is_zero, emit.number(least), by);
    }
    out.push_back(std::move(in));
  }
  region.body = std::move(out);
}

}  // namespace

void derive_edges(ir::Module& module, const Decisions& found, const InputChanges& changes) {
  Decisions decisions = found;
  leave_out_searches(module.main().body, decisions);
  widen_steps(module.main(), module.main().body);
  // Loops' heads are copied behind and into the loops, so that the edges that they decide count.
  rotate_loops(module.main(), decisions);
  EdgeWatcher watcher(decisions, Roots(module));
  const std::vector<Value> edges =
      passes::derive_main(module, slopes_of_inputs(module, changes), {.watcher = &watcher});
  module.outputs.clear();
  for (const char* line : {"$first", "$second"})
    for (const char* part : {".distance", ".nx", ".ny"})
      module.outputs.push_back({std::string(line) + part});
  module.main().body.yields = edges;
}

void derive_outputs(ir::Module& module, const InputChanges& changes) {
  passes::derive_main(module, slopes_of_inputs(module, changes), {.yield_slopes = true});
  const std::vector<ir::Output> outputs = module.outputs;
  for (const ir::Output& output : outputs) {
    module.outputs.push_back({output.name + "$x"});
    module.outputs.push_back({output.name + "$y"});
  }
}

}  // namespace pse::antialias
