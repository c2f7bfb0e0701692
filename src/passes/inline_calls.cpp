// Inlining: small functions always, larger ones where there is only one call. The others stay
// calls, so that compile time is bounded.
#include <utility>

#include "ir/count.h"
#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

class Inliner {
 public:
  Inliner(ir::Module& module, const InlineOptions& options)
      : module_(module),
        options_(options),
        sizes_(module.functions.size()),
        sites_(module.functions.size(), 0),
        done_(module.functions.size(), false) {}

  void run() {
    for (std::size_t i = 0; i < sizes_.size(); ++i) {
      sizes_[i] = ir::count_instructions(module_.functions[i]);
      total_ += sizes_[i];
      count_sites(module_.functions[i].body);
    }
    for (std::size_t i = 0; i < sizes_.size(); ++i) process(i);
  }

 private:
  void count_sites(const Region& region) {
    for (const Instruction& in : region.body) {
      if (in.op == Op::call) ++sites_[static_cast<std::size_t>(in.imm)];
      for (const Region& inner : in.regions) count_sites(inner);
    }
  }

  // Callees are finished before their callers, so what is copied has been inlined itself.
  void process(std::size_t index) {
    if (done_[index]) return;
    done_[index] = true;
    process_callees(module_.functions[index].body);
    Function& function = module_.functions[index];
    Renaming renaming(function.values.size());
    inline_in(function, function.body, renaming);
    sizes_[index] = ir::count_instructions(function);
  }

  void process_callees(const Region& region) {
    for (const Instruction& in : region.body) {
      if (in.op == Op::call) process(static_cast<std::size_t>(in.imm));
      for (const Region& inner : in.regions) process_callees(inner);
    }
  }

  bool is_wanted(std::size_t callee) const {
    if (total_ + sizes_[callee] > options_.max_total) return false;
    return sizes_[callee] <= options_.small ||
           (sites_[callee] == 1 && sizes_[callee] <= options_.single &&
            callee < options_.first_kept);
  }

  void inline_in(Function& function, Region& region, Renaming& renaming) {
    std::vector<Instruction> out;
    out.reserve(region.body.size());
    for (Instruction& in : region.body) {
      renaming.apply(in.operands);
      for (Region& inner : in.regions) inline_in(function, inner, renaming);
      const auto callee = static_cast<std::size_t>(in.imm);
      if (in.op == Op::call && is_wanted(callee)) {
        total_ += sizes_[callee];
        copy(function, module_.functions[callee], in, out, renaming);
      } else {
        out.push_back(std::move(in));
      }
    }
    region.body = std::move(out);
    renaming.apply(region.yields);
  }

  // The callee's body with fresh values, its parameters being the call's operands.
  static void copy(Function& function, const Function& callee, const Instruction& call,
                   std::vector<Instruction>& out, Renaming& renaming) {
    const auto first = static_cast<Value>(function.values.size());
    Renaming fresh(callee.values.size());
    for (Value value = 0; value < callee.values.size(); ++value) {
      function.values.push_back(callee.values[value]);
      fresh.set(value, first + value);
    }
    for (std::size_t i = 0; i < call.operands.size(); ++i)
      fresh.set(callee.body.params[i], call.operands[i]);
    for (const Instruction& in : callee.body.body) {
      out.push_back(in);
      rename_all(out.back(), fresh);
    }
    for (std::size_t i = 0; i < call.results.size(); ++i) {
      renaming.set(call.results[i], fresh(callee.body.yields[i]));
    }
  }

  static void rename_all(Instruction& in, const Renaming& fresh) {
    fresh.apply(in.operands);
    fresh.apply(in.results);
    for (Region& region : in.regions) {
      fresh.apply(region.params);
      fresh.apply(region.yields);
      for (Instruction& inner : region.body) rename_all(inner, fresh);
    }
  }

  ir::Module& module_;
  const InlineOptions& options_;
  std::vector<std::size_t> sizes_;
  std::vector<std::size_t> sites_;
  std::vector<bool> done_;
  std::size_t total_ = 0;
};

}  // namespace

void inline_calls(ir::Module& module, const InlineOptions& options) {
  Inliner(module, options).run();
}

}  // namespace pse::passes
