// Large programs that write a function into many places: the copies that are alike become one
// function again, which is compiled once. Small programs keep everything in one place, which runs
// faster. docs/decisions/2026-11-23-compile-time.md has the numbers.
#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <map>
#include <span>
#include <utility>

#include "ir/count.h"
#include "passes/call_copies.h"
#include "passes/passes.h"

namespace pse::passes {
namespace {

using ir::CallRange;
using ir::Function;
using ir::Instruction;
using ir::Region;
using ir::Value;

// One function of the module and the calls that were written into it.
class Outliner {
 public:
  Outliner(ir::Module& module, std::size_t function, const OutlineOptions& options)
      : module_(module), index_(function), options_(options), body_(module.functions[function]) {}

  // Appends functions to the module; returns each with the calls inside it.
  std::vector<std::pair<std::size_t, std::vector<CallRange>>> run(
      const std::vector<CallRange>& calls) {
    for (const CallRange& call : calls) {
      // All that may move defines values, so that this is quickly told of most.
      if (call.end - call.first < options_.min_size) continue;
      auto copy = body_.find(call);
      // A single instruction is a call already, or not worth one.
      if (copy && copy->size > 1 && copy->size >= options_.min_size)
        copies_.push_back(std::move(*copy));
    }
    // What saves most comes first; what overlaps it has its turn in the next round.
    std::map<std::vector<std::int32_t>, std::vector<const CallCopy*>> by_shape;
    for (const CallCopy& copy : copies_) {
      // A function that only calls another is the same copy twice.
      auto& group = by_shape[copy.shape];
      const auto same = [&](const CallCopy* other) { return overlap(*other, copy); };
      if (std::ranges::none_of(group, same)) group.push_back(&copy);
    }
    std::vector<std::vector<const CallCopy*>> groups;
    for (auto& [shape, group] : by_shape) groups.push_back(std::move(group));
    std::ranges::stable_sort(groups, std::greater(), &Outliner::saved);
    for (std::vector<const CallCopy*>& group : groups) {
      std::erase_if(group, [&](const CallCopy* copy) { return is_covered(*copy); });
      if (saved(group) >= options_.min_saved) share(group);
    }
    cut();
    apply();
    return std::move(made_);
  }

 private:
  struct Replacement {
    const CallCopy* copy;
    std::vector<Instruction> by;
  };

  // Where a function is still too large to compile beside the others, some of its calls leave it
  // although they are one of a kind.
  void cut() {
    std::size_t size = ir::count_instructions(module_.functions[index_]);
    for (const CallCopy* copy : taken_) size -= std::min(size, copy->size);
    std::vector<std::vector<const CallCopy*>> singles;
    for (const CallCopy& copy : copies_) singles.push_back({&copy});
    std::ranges::stable_sort(singles, std::greater(), [](const auto& one) { return one[0]->size; });
    for (const auto& one : singles) {
      const std::size_t copy = one[0]->size;
      if (size <= options_.max_function || copy < options_.min_cut) return;
      if (copy > options_.max_function || is_covered(*one[0])) continue;
      share(one);
      size -= copy;
    }
  }

  static std::size_t saved(const std::vector<const CallCopy*>& group) {
    return group.size() < 2 ? 0 : (group.size() - 1) * group.front()->size;
  }

  static bool overlap(const CallCopy& a, const CallCopy& b) {
    return std::max(a.values.first, b.values.first) < std::min(a.values.end, b.values.end);
  }

  bool is_covered(const CallCopy& copy) const {
    return std::ranges::any_of(taken_,
                               [&](const CallCopy* other) { return overlap(*other, copy); });
  }

  // What the operands that come from outside are, in one copy after the other.
  using Source = std::vector<std::array<std::int64_t, 3>>;

  Source source_of(const std::vector<const CallCopy*>& copies, std::size_t slot) const {
    Source source;
    for (const CallCopy* copy : copies) {
      const Value value = copy->outside[slot];
      const Instruction* leaf = body_.leaf(value);
      if (leaf) {
        source.push_back({static_cast<std::int64_t>(leaf->op), leaf->imm, 1});
      } else {
        source.push_back({value, 0, 0});
      }
    }
    return source;
  }

  void share(const std::vector<const CallCopy*>& copies) {
    const CallCopy& model = *copies.front();
    // Results: whatever any of the copies hands on.
    std::vector<std::size_t> results;
    for (const CallCopy* copy : copies)
      results.insert(results.end(), copy->live.begin(), copy->live.end());
    std::ranges::sort(results);
    results.erase(std::ranges::unique(results).begin(), results.end());

    // Parameters: what comes from outside, unless it is the same constant everywhere.
    Function made;
    made.name = "copies." + std::to_string(module_.functions.size() + pending_.size());
    CopyWriter writer(module_.functions[index_], made);
    std::map<Source, Value> sources;
    std::vector<std::size_t> parameters;  // the slot that each comes from
    std::vector<Instruction> constants;
    for (std::size_t slot = 0; slot < model.outside.size(); ++slot) {
      const Source source = source_of(copies, slot);
      if (sources.contains(source)) continue;
      const Value value = made.add_value(body_.type(model.outside[slot]));
      sources.emplace(source, value);
      const Instruction* leaf = body_.leaf(model.outside[slot]);
      const bool same = std::ranges::all_of(source, [&](const auto& s) { return s == source[0]; });
      if (leaf && leaf->op != ir::Op::input && same) {
        constants.push_back({.op = leaf->op, .results = {value}, .imm = leaf->imm});
      } else {
        made.body.params.push_back(value);
        parameters.push_back(slot);
      }
    }
    if (results.empty() || results.size() > options_.max_results ||
        parameters.size() > options_.max_parameters)
      return;
    for (std::size_t slot = 0; slot < model.outside.size(); ++slot)
      writer.outside.push_back(sources.at(source_of(copies, slot)));
    made.body.body = std::move(constants);
    writer.write(model);
    for (const std::size_t result : results)
      made.body.yields.push_back(writer.fresh(model.defined[result]));

    const auto function = static_cast<std::int32_t>(module_.functions.size() + pending_.size());
    for (const CallCopy* copy : copies) {
      taken_.push_back(copy);
      replacements_.push_back({copy, call_of(*copy, function, parameters, results)});
    }
    std::vector<CallRange> inner;
    for (const CallCopy& copy : copies_) {
      if (&copy == &model || copy.values.first < model.values.first ||
          copy.values.end > model.values.end)
        continue;
      if (const auto range = writer.range_of(copy)) inner.push_back(*range);
    }
    made_.emplace_back(static_cast<std::size_t>(function), std::move(inner));
    pending_.push_back(std::move(made));
  }

  // The call, behind the constants and inputs that it may need.
  std::vector<Instruction> call_of(const CallCopy& copy, std::int32_t function,
                                   const std::vector<std::size_t>& parameters,
                                   const std::vector<std::size_t>& results) {
    std::vector<Instruction> made;
    std::span<Instruction> all(copy.region->body);
    for (const Instruction& in : all.subspan(copy.from, copy.to - copy.from))
      if (is_leaf(in)) made.push_back(in);
    Instruction call{.op = ir::Op::call, .imm = function, .span = all[copy.from].span};
    for (const std::size_t slot : parameters) {
      Value value = copy.outside[slot];
      if (const Instruction* leaf = body_.leaf(value)) {
        // It may stand in a place that is not seen from here.
        value = module_.functions[index_].add_value(body_.type(value));
        made.push_back({.op = leaf->op, .results = {value}, .imm = leaf->imm, .span = leaf->span});
      }
      call.operands.push_back(value);
    }
    for (const std::size_t result : results) call.results.push_back(copy.defined[result]);
    made.push_back(std::move(call));
    return made;
  }

  void apply() {
    // From the back of each region, so that places stay.
    std::ranges::stable_sort(replacements_, std::greater(),
                             [](const Replacement& r) { return r.copy->from; });
    for (Replacement& r : replacements_) {
      auto& body = r.copy->region->body;
      const auto first = body.begin() + static_cast<std::ptrdiff_t>(r.copy->from);
      const auto last = body.begin() + static_cast<std::ptrdiff_t>(r.copy->to);
      const auto place = body.erase(first, last);
      body.insert(place, std::make_move_iterator(r.by.begin()),
                  std::make_move_iterator(r.by.end()));
    }
    for (Function& function : pending_) module_.functions.push_back(std::move(function));
  }

  ir::Module& module_;
  std::size_t index_;
  const OutlineOptions& options_;
  CallBody body_;
  std::vector<CallCopy> copies_;
  std::vector<const CallCopy*> taken_;
  std::vector<Replacement> replacements_;
  std::vector<Function> pending_;
  std::vector<std::pair<std::size_t, std::vector<CallRange>>> made_;
};

// Checks of what is known to be true.
void drop_passed_checks(Region& region, std::vector<bool>& is_true) {
  std::erase_if(region.body, [&](const Instruction& in) {
    if (in.op == ir::Op::const_bool) is_true[in.result()] = in.imm != 0;
    return in.op == ir::Op::check && is_true[in.operands[0]];
  });
  for (Instruction& in : region.body)
    for (Region& inner : in.regions) drop_passed_checks(inner, is_true);
}

}  // namespace

std::size_t outline(ir::Module& module, const std::vector<CallRange>& calls,
                    const OutlineOptions& options) {
  const std::size_t before = module.functions.size();
  if (ir::count_instructions(module.main()) < options.min_total) return before;
  // What can fail stays where it is, so whatever cannot is found out first.
  decide(module);
  for (Function& function : module.functions) {
    std::vector<bool> is_true(function.values.size());
    drop_passed_checks(function.body, is_true);
  }
  remove_dead(module, {.functions = false});
  std::vector<std::pair<std::size_t, std::vector<CallRange>>> work = {{module.entry, calls}};
  while (!work.empty()) {
    auto [function, inside] = std::move(work.back());
    work.pop_back();
    auto made = Outliner(module, function, options).run(inside);
    if (made.empty()) continue;
    work.emplace_back(function, std::move(inside));  // larger copies may be alike now
    std::ranges::move(made, std::back_inserter(work));
  }
  return before;
}

}  // namespace pse::passes
