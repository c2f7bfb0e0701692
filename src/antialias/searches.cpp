// Searches told from counts by what the turns hand on to each other.
#include "antialias/searches.h"

#include <algorithm>

#include "passes/rewrite.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

bool stores(const Region& region) {
  return std::ranges::any_of(region.body, [](const Instruction& in) {
    return passes::writes_array(in.op) || std::ranges::any_of(in.regions, stores);
  });
}

// What instructions use, in regions inside too.
void find_uses(const Region& region, std::vector<bool>& used) {
  const auto use = [&](const std::vector<Value>& values) {
    for (const Value value : values) used[value] = true;
  };
  for (const Instruction& in : region.body) {
    use(in.operands);
    for (const Region& inner : in.regions) find_uses(inner, used);
  }
  use(region.yields);
}

class Searches {
 public:
  Searches(const Function& function, Decisions& found)
      : function_(function), found_(found), used_(function.values.size()) {
    find_uses(function.body, used_);
    for (std::size_t value = 0; value < found.expected.size(); ++value)
      if (found.expected[value]) used_[value] = false;
    found.searched.resize(function.values.size());
    found.ends.resize(function.values.size());
  }

  void find(const Region& region) {
    for (const Instruction& in : region.body) {
      if (in.op == Op::loop && !found_.is_dither(in) && is_search(in)) {
        found_.searched[in.regions[0].yields[0]] = true;
        for (const Value end : in.results) found_.ends[end] = used_[end];
      }
      for (const Region& inner : in.regions) find(inner);
    }
  }

 private:
  bool differs(Value value) const { return function_.values[value].rate == ir::Rate::sample; }

  bool is_search(const Instruction& loop) const {
    const Region &head = loop.regions[0], &body = loop.regions[1];
    if (!differs(head.yields[0]) || stores(head) || stores(body)) return false;
    // What is computed from the number of the turn alone.
    std::vector<bool> of_turn(function_.values.size());
    for (std::size_t k = 0; k < body.params.size(); ++k)
      of_turn[body.params[k]] =
          body.yields[k] != body.params[k] && adds(body, body.yields[k], body.params[k]);
    follow(body, of_turn);
    for (std::size_t k = 0; k < loop.results.size(); ++k)
      if (used_[loop.results[k]] &&
          (of_turn[body.params[k]] || ends_as(body, body.yields[k], of_turn)))
        return false;
    return goes_on(head, body);
  }

  // Whether what the turns make of each other's values, a way along a ray, decides how many there
  // are. A loop that only leaves at the first of some conditions does not search.
  bool goes_on(const Region& head, const Region& body) const {
    std::vector<bool> on_way(function_.values.size());
    const auto makes_one = [&](Value value, const std::vector<bool>& marked) {
      return makes(body, value, body.params, marked);
    };
    for (const Value param : body.params)
      on_way[param] = function_.values[param].type == ir::Type::f32 && differs(param);
    std::vector<bool> from_way;
    for (bool changed = true; changed;) {
      changed = false;
      from_way = on_way;
      spread(body, from_way);
      for (std::size_t k = 0; k < body.params.size(); ++k)
        if (on_way[body.params[k]] && !makes_one(body.yields[k], from_way)) {
          on_way[body.params[k]] = false;
          changed = true;
        }
    }
    for (std::size_t k = 0; k < body.params.size(); ++k)
      from_way[head.params[k]] = on_way[body.params[k]] || from_way[body.yields[k]];
    spread(head, from_way);
    return from_way[head.yields[0]];
  }

  // Marks what is computed from marked values, or chosen by them.
  static void spread(const Region& region, std::vector<bool>& marked) {
    for (const Instruction& in : region.body) {
      bool any = std::ranges::any_of(in.operands, [&](Value value) { return marked[value]; });
      for (const Region& inner : in.regions) {
        spread(inner, marked);
        any = any || std::ranges::any_of(inner.yields, [&](Value value) { return marked[value]; });
      }
      for (const Value result : in.results) marked[result] = marked[result] || any;
    }
  }

  // Whether a turn computes the value from marked ones, and does not only hand one on.
  static bool makes(const Region& region, Value value, const std::vector<Value>& handed,
                    const std::vector<bool>& marked) {
    const auto [in, k] = source(region, value);
    if (in == nullptr || in->op != Op::if_)
      return marked[value] && std::ranges::find(handed, value) == handed.end();
    return std::ranges::any_of(in->regions, [&](const Region& inner) {
      return makes(inner, inner.yields[k], handed, marked);
    });
  }

  void follow(const Region& region, std::vector<bool>& of_turn) const {
    for (const Instruction& in : region.body) {
      for (const Region& inner : in.regions) follow(inner, of_turn);
      if (!in.regions.empty() || in.results.size() != 1) continue;
      const auto& from = in.operands;
      of_turn[in.result()] =
          std::ranges::any_of(from, [&](Value value) { return of_turn[value]; }) &&
          std::ranges::all_of(from, [&](Value value) { return of_turn[value] || !differs(value); });
    }
  }

  // The instruction of a region that gives the value, and which of its results it is.
  static std::pair<const Instruction*, std::size_t> source(const Region& region, Value value) {
    for (const Instruction& in : region.body)
      if (const auto at = std::ranges::find(in.results, value); at != in.results.end())
        return {&in, static_cast<std::size_t>(at - in.results.begin())};
    return {nullptr, 0};
  }

  // Whether a turn makes `before` into `after` by adding a step to it that is the same everywhere,
  // or leaves it.
  bool adds(const Region& region, Value after, Value before) const {
    if (after == before) return true;
    const auto [in, k] = source(region, after);
    if (in == nullptr) return false;
    if (in->op == Op::fadd || in->op == Op::iadd)
      return (in->operands[0] == before && !differs(in->operands[1])) ||
             (in->operands[1] == before && !differs(in->operands[0]));
    return in->op == Op::if_ && std::ranges::all_of(in->regions, [&](const Region& inner) {
             return adds(inner, inner.yields[k], before);
           });
  }

  // Whether a turn may end with a value that is marked.
  static bool ends_as(const Region& region, Value value, const std::vector<bool>& marked) {
    if (marked[value]) return true;
    const auto [in, k] = source(region, value);
    return in != nullptr && in->op == Op::if_ &&
           std::ranges::any_of(in->regions, [&](const Region& inner) {
             return ends_as(inner, inner.yields[k], marked);
           });
  }

  const Function& function_;
  Decisions& found_;
  std::vector<bool> used_;
};

// All decisions of a region and of those inside.
void leave_out(const Region& region, Decisions& decisions) {
  for (const Instruction& in : region.body) {
    for (const Value value : in.results)
      if (value < decisions.forks.size()) decisions.forks[value] = decisions.bends[value] = false;
    for (const Region& inner : in.regions) leave_out(inner, decisions);
  }
}

}  // namespace

void find_searches(const Function& function, Decisions& found) {
  Searches(function, found).find(function.body);
}

void leave_out_searches(const Region& region, Decisions& decisions) {
  for (const Instruction& in : region.body)
    for (const Region& inner : in.regions)
      if (decisions.is_search(in))
        leave_out(inner, decisions);
      else
        leave_out_searches(inner, decisions);
}

}  // namespace pse::antialias
