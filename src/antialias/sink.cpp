// From the last instruction to the first, since what uses a value may have moved itself.
#include "antialias/sink.h"

#include <algorithm>

#include "antialias/decisions.h"
#include "passes/rewrite.h"
#include "passes/slice.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

bool may_move(const Instruction& in) {
  return ir::info(in.op).pure && in.op != Op::external && in.op != Op::input &&
         !passes::is_constant(in.op) && !passes::reads_array(in.op) &&
         !passes::has_regions(in.op) && !in.results.empty();
}

bool is_step(Cut cut) { return cut == Cut::whole || cut == Cut::half; }

template <class Visit>
void for_each(const Region& region, const Visit& visit) {
  for (const Instruction& in : region.body) {
    visit(in);
    for (const Region& inner : in.regions) for_each(inner, visit);
  }
}

// What a jump is computed from; not that of steps which only choose a random number.
std::vector<bool> find_deciding(const Function& function) {
  std::vector<bool> of_all, deciding;
  for (std::vector<bool>* found : {&of_all, &deciding}) {
    passes::Slice slice(function, false);
    for_each(function.body, [&](const Instruction& in) {
      const Cut cut = cut_of(in.op);
      if (cut == Cut::none || cut == Cut::kink) return;
      if (found == &deciding && is_step(cut) && !of_all[in.result()]) return;
      for (const Value operand : in.operands) slice.need(operand);
    });
    slice.run();
    for (Value value = 0; value < function.values.size(); ++value) found->push_back(slice[value]);
  }
  return deciding;
}

class Sinking {
 public:
  explicit Sinking(const Function& function)
      : users_(function.values.size()), deciding_(find_deciding(function)) {}

  void walk(Region& region) {
    std::vector<Instruction>& body = region.body;
    for (const Instruction& in : body)
      for (const Value value : in.results) users_[value] = User{};
    for (const Value value : region.yields) use(value, several);
    std::vector<bool> moves(body.size());
    std::vector<User> places(body.size());
    for (std::size_t i = body.size(); i-- > 0;) {
      const Instruction& in = body[i];
      const User place = may_move(in) && !decides(in) ? user_of(in) : several;
      moves[i] = place.in != none && place.in != several.in;
      places[i] = place;
      for (const Value value : in.operands) use(value, moves[i] ? place : several);
      for (std::size_t k = 0; k < in.regions.size(); ++k)
        use_all(in.regions[k], in.op == Op::if_ ? User{i, k} : several);
    }
    if (std::ranges::find(moves, true) != moves.end()) move(body, moves, places);
    for (Instruction& in : body)
      for (Region& inner : in.regions) walk(inner);
  }

 private:
  // Who uses a value: branch `region` of instruction `in`.
  static constexpr auto none = static_cast<std::size_t>(-1);
  struct User {
    std::size_t in = none, region = 0;
    bool operator==(const User&) const = default;
  };
  static constexpr User several{none - 1, 0};

  bool decides(const Instruction& in) const {
    const Cut cut = cut_of(in.op);
    return cut == Cut::compare || (cut != Cut::none && deciding_[in.result()]);
  }

  void use(Value value, const User& by) {
    User& user = users_[value];
    user = user.in == none || user == by ? by : several;
  }
  void use_all(const Region& region, const User& by) {
    for (const Value value : region.yields) use(value, by);
    for (const Instruction& in : region.body) {
      for (const Value value : in.operands) use(value, by);
      for (const Region& inner : in.regions) use_all(inner, by);
    }
  }
  User user_of(const Instruction& in) const {
    User user = users_[in.results[0]];
    for (const Value result : in.results)
      if (users_[result] != user) user = several;
    return user;
  }

  // In the order in which they were, before what is there.
  static void move(std::vector<Instruction>& body, const std::vector<bool>& moves,
                   const std::vector<User>& places) {
    for (std::size_t i = body.size(); i-- > 0;) {
      if (!moves[i]) continue;
      std::vector<Instruction>& to = body[places[i].in].regions[places[i].region].body;
      to.insert(to.begin(), std::move(body[i]));
    }
    std::size_t k = 0;
    std::erase_if(body, [&](const Instruction&) { return moves[k++]; });
  }

  std::vector<User> users_;  // within the region that is walked
  std::vector<bool> deciding_;
};

}  // namespace

void sink_into_branches(ir::Module& module) { Sinking(module.main()).walk(module.main().body); }

}  // namespace pse::antialias
