// Which calls are looked at, and what is asked of them.
#include "antialias/fine.h"

#include <algorithm>
#include <numbers>

#include "antialias/decisions.h"
#include "passes/slice.h"
#include "passes/slope_rules.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::no_value;
using ir::Op;
using ir::Region;
using ir::Value;
using passes::Slice;

// Noise is mostly made of waves a little longer than a lattice cell.
constexpr float cells_per_period = 1.3f;

bool is_wave(const std::string& name) { return name == "sin" || name == "cos"; }

class Search {
 public:
  Search(const ir::Module& module, const Decisions& decisions, const InputChanges& changes)
      : module_(module),
        main_(module.main()),
        decisions_(decisions),
        changes_(changes),
        found_{std::vector<bool>(main_.values.size())} {}

  Noises find(const std::vector<bool>& wanted) && {
    wanted_ = &wanted;
    return run();
  }
  Noises find_noise(const Slice& decided) && {
    decided_ = &decided;
    return run();
  }

 private:
  Noises run() {
    walk(main_.body);
    return std::move(found_);
  }

  void walk(const Region& region) {
    for (const Instruction& in : region.body) {
      if (is_wanted(in) && differs(in)) {
        found_.told[in.results[0]] = is_cheap(in);
        found_.others = found_.others || !found_.told[in.results[0]];
      }
      if (decisions_.is_dither(in) || (in.op == Op::loop && !is_open(in))) continue;
      for (const Region& inner : in.regions) walk(inner);
    }
  }

  bool is_wanted(const Instruction& in) const {
    if (wanted_ == nullptr) return in.op == Op::call && is_noise(in);
    return in.results.size() == 1 && (*wanted_)[in.result()];
  }

  bool is_noise(const Instruction& call) const {
    const std::string& name = module_.functions[static_cast<std::size_t>(call.imm)].name;
    return name.find("noise") != std::string::npos ||
           (is_wave(name) && !(*decided_)[call.results[0]]);
  }

  bool turns_differ(const Instruction& loop) const {
    return main_.values[loop.regions[0].yields[0]].rate == ir::Rate::sample;
  }

  // Whether what stands in the loop is looked at.
  bool is_open(const Instruction& loop) const {
    return wanted_ == nullptr ? !turns_differ(loop) : !decisions_.is_search(loop);
  }

  bool differs(const Instruction& in) const {
    const Value result = in.results[0];
    return main_.values[result].rate == ir::Rate::sample &&
           !(result < decisions_.dithered.size() && decisions_.dithered[result]);
  }

  // Whether the slopes of all that the call gets are found with little work.
  bool is_cheap(const Instruction& call) const {
    Slice slice(main_);
    for (const Value operand : call.operands)
      if (main_.values[operand].rate == ir::Rate::sample) slice.need(operand);
    slice.run();
    const auto is_place = [&](const Instruction& in) {
      return in.op == Op::input && input(in).rate == ir::Rate::sample;
    };
    return !none_of(main_.body, slice, is_place) &&
           none_of(main_.body, slice, [&](const Instruction& in) {
             switch (in.op) {
               case Op::call:
                 return !passes::has_partials(
                     module_.functions[static_cast<std::size_t>(in.imm)].name);
               case Op::loop:
                 return turns_differ(in) && std::ranges::any_of(in.results, [&](Value result) {
                          return slice[result] && main_.values[result].type == ir::Type::f32;
                        });
               case Op::input:
                 return is_place(in) && moves_unevenly(input(in).name);
               default:
                 return in.op == Op::slope || in.op == Op::external || in.op == Op::array_load;
             }
           });
  }

  const ir::Input& input(const Instruction& in) const {
    return module_.inputs[static_cast<std::size_t>(in.imm)];
  }
  bool moves_unevenly(const std::string& name) const {
    const auto [along_x, along_y] = changes_(name);
    return along_x == Change::any || along_y == Change::any;
  }

  template <class Is>
  static bool none_of(const Region& region, const Slice& slice, const Is& is) {
    return std::ranges::none_of(region.body, [&](const Instruction& in) {
      const bool is_needed =
          std::ranges::any_of(in.results, [&](Value result) { return slice[result]; });
      return (is_needed && is(in)) || !std::ranges::all_of(in.regions, [&](const Region& inner) {
               return none_of(inner, slice, is);
             });
    });
  }

  const ir::Module& module_;
  const Function& main_;
  const Decisions& decisions_;
  const InputChanges& changes_;
  Noises found_;
  const std::vector<bool>* wanted_ = nullptr;  // null: noise and waves
  const Slice* decided_ = nullptr;             // of these
};

}  // namespace

Noises find_noise(const ir::Module& module, const Decisions& decisions, const InputChanges& changes,
                  const Slice& decided) {
  return Search(module, decisions, changes).find_noise(decided);
}

std::vector<bool> find_cheap(const ir::Module& module, const Decisions& decisions,
                             const InputChanges& changes, const std::vector<bool>& wanted) {
  return Search(module, decisions, changes).find(wanted).told;
}

Value move_squared(const passes::Emit& emit, const ir::Module& module, const Instruction& call) {
  Value along[2];
  for (std::int32_t k = 0; k < 2; ++k) {
    Value sum = emit.number(0);
    for (const Value operand : call.operands) {
      const ir::ValueInfo& value = emit.function().values[operand];
      if (value.type != ir::Type::f32 || value.rate != ir::Rate::sample) continue;
      const Value slope = emit(Op::slope, {operand}, k);
      sum = emit(Op::fma, {slope, slope, sum});
    }
    along[k] = sum;
  }
  const Value farthest = emit(Op::fmax, {along[0], along[1]});
  if (!is_wave(module.functions[static_cast<std::size_t>(call.imm)].name)) return farthest;
  constexpr float cells = cells_per_period / (2 * std::numbers::pi_v<float>);
  return emit.mul(farthest, emit.number(cells * cells));
}

}  // namespace pse::antialias
