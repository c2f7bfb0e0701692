// If-conversion: an if whose sides are small and without effects becomes straight code and a select
// per result. Inner ifs first, so that a chain of small ones becomes selects as far as the cost
// allows.
#include <utility>

#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;

// Loads may run in vain as well: an index outside gives 0.
bool may_run_in_vain(Op op) { return is_cheap_and_pure(op) || reads_array(op); }

bool is_small(const Instruction& in, const ConvertOptions& options) {
  int cost = static_cast<int>(in.results.size());
  for (const Region& side : in.regions) {
    for (const Instruction& inner : side.body) {
      if (!may_run_in_vain(inner.op)) return false;
      cost += cost_of(inner.op);
      if (cost > options.max_cost) return false;
    }
  }
  return true;
}

void convert(Region& region, const ConvertOptions& options) {
  std::vector<Instruction> out;
  out.reserve(region.body.size());
  for (Instruction& in : region.body) {
    for (Region& inner : in.regions) convert(inner, options);
    if (in.op != Op::if_ || !is_small(in, options)) {
      out.push_back(std::move(in));
      continue;
    }
    for (Region& side : in.regions) {
      for (Instruction& inner : side.body) out.push_back(std::move(inner));
    }
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      out.push_back({.op = Op::select,
                     .operands = {in.operands[0], in.regions[0].yields[i], in.regions[1].yields[i]},
                     .results = {in.results[i]},
                     .span = in.span});
    }
  }
  region.body = std::move(out);
}

}  // namespace

void convert_ifs(ir::Module& module, const ConvertOptions& options) {
  for (ir::Function& function : module.functions) convert(function.body, options);
}

}  // namespace pse::passes
