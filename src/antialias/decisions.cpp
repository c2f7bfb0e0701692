// Finding cuts by operator and rate, and the kinks that bend them by what they are computed from.
#include "antialias/decisions.h"

#include <algorithm>

#include "antialias/bent.h"
#include "antialias/dither.h"
#include "antialias/fine.h"
#include "antialias/seams.h"
#include "antialias/searches.h"
#include "antialias/sink.h"
#include "ir/expectations.h"
#include "passes/passes.h"
#include "passes/slice.h"
#include "passes/slope_rules.h"

namespace pse::antialias {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// All instructions but those inside of dither, and whether they stand in a loop.
template <class Visit>
void for_each(const Region& region, const Decisions& found, const Visit& visit,
              bool in_loop = false) {
  for (const Instruction& in : region.body) {
    visit(in, in_loop);
    if (found.is_dither(in)) continue;
    for (const Region& inner : in.regions)
      for_each(inner, found, visit, in_loop || in.op == Op::loop);
  }
}

bool uses_noise(const ir::Module& module, const passes::Slice& slice, const Region& region) {
  return std::ranges::any_of(region.body, [&](const Instruction& in) {
    if (in.op == Op::call)
      return slice[in.results[0]] &&
             !passes::has_partials(module.functions[static_cast<std::size_t>(in.imm)].name);
    return std::ranges::any_of(
        in.regions, [&](const Region& inner) { return uses_noise(module, slice, inner); });
  });
}

// Whether a value is computed from noise: from any function but those of the math library. Octave
// by octave, as turbulence folds it, it does so all over the picture.
bool is_of_noise(const ir::Module& module, Value value) {
  passes::Slice slice(module.main());
  slice.need(value);
  slice.run();
  return uses_noise(module, slice, module.main().body);
}

bool is_ray(const ir::Module& module, const Instruction& external) {
  const std::string& name = module.externals[static_cast<std::size_t>(external.imm)].name;
  return name == "trace" || name == "visible" || name == "radiance";
}

void find_defined(const Region& region, std::vector<bool>& defined) {
  for (const Instruction& in : region.body) {
    for (const Value result : in.results) defined[result] = true;
    for (const Region& inner : in.regions) find_defined(inner, defined);
  }
}

// What is gone with the expectations was wanted for them alone.
std::vector<bool> find_expected(const ir::Module& module) {
  std::vector<bool> found(module.main().values.size());
  if (!ir::has_expectations(module)) return found;
  found = defined_values(module.main());
  ir::Module bare = module;
  ir::drop_expectations(bare);
  passes::remove_dead(bare, {.arrays = false, .functions = false});
  const std::vector<bool> left = defined_values(bare.main());
  for (std::size_t value = 0; value < found.size(); ++value)
    if (left[value]) found[value] = false;
  return found;
}

// Marks what says where on a ray a prepass has found matter: what is computed from its inputs, but
// not what loops do there.
void find_guides(const ir::Module& module, const Region& region, std::vector<bool>& found) {
  for (const Instruction& in : region.body) {
    bool guides = false;
    if (in.op == Op::input) {
      const std::string& name = module.inputs[static_cast<std::size_t>(in.imm)].name;
      guides = name == "prepass.near" || name == "prepass.far";
    }
    // What a condition chooses is no guide by that.
    const std::size_t chooses = in.op == Op::if_ || in.op == Op::select ? 1 : 0;
    for (std::size_t k = chooses; k < in.operands.size(); ++k)
      guides = guides || found[in.operands[k]];
    for (const Region& inner : in.regions) find_guides(module, inner, found);
    if (in.op == Op::loop) continue;
    for (std::size_t k = 0; k < in.results.size(); ++k) {
      found[in.results[k]] = guides;
      for (const Region& inner : in.regions)
        found[in.results[k]] = found[in.results[k]] || found[inner.yields[k]];
    }
  }
}

}  // namespace

std::vector<bool> defined_values(const Function& function) {
  std::vector<bool> defined(function.values.size());
  find_defined(function.body, defined);
  return defined;
}

Cut cut_of(Op op) {
  switch (op) {
    case Op::flt:
    case Op::fle:
      return Cut::compare;
    case Op::ffloor:
    case Op::fceil:
    case Op::ftrunc:
    case Op::f2i:
      return Cut::whole;
    case Op::fround:
      return Cut::half;
    case Op::fmin:
    case Op::fmax:
    case Op::fabs:
      return Cut::kink;
    default:
      return Cut::none;
  }
}

Decisions find_decisions(ir::Module& module, const InputChanges& changes) {
  const std::size_t own = module.main().values.size();
  std::vector<bool> expected = find_expected(module);
  const std::vector<Value> seams = add_seams(module);
  sink_into_branches(module);
  // A picture is the same whatever part of a ray the prepass leaves out, and so are its edges.
  std::vector<bool> guides(module.main().values.size());
  find_guides(module, module.main().body, guides);
  passes::assign_rates(module);
  const Function& main = module.main();
  Decisions found;
  found.expected = std::move(expected);
  found.expected.resize(main.values.size());
  found.forks.resize(main.values.size());
  found.bends.resize(main.values.size());
  found.creases.resize(main.values.size());
  passes::Slice bends(main), lines(main, false), shown(main);
  // Dither is no edge: it decides anew in each pixel, and a ray marcher with a jittered step does
  // so all along its way.
  found.dithered = find_dither(module);
  const auto differs = [&](const Instruction& in) {
    const Value result = in.result();
    return main.values[result].rate == ir::Rate::sample && !found.dithered[result] &&
           !found.expected[result] && !guides[result];
  };
  for_each(main.body, found, [&](const Instruction& in, bool) {
    const Cut cut = cut_of(in.op);
    if (cut == Cut::none || in.op == Op::fabs || !differs(in)) return;
    // Of what lays a seam open the seam alone is a decision.
    if (in.result() >= own && std::ranges::find(seams, in.result()) == seams.end()) return;
    found.forks[in.result()] = true;
    if (cut == Cut::kink) return;
    found.any_jump = true;
    shown.end_at(in.result());
    for (const Value operand : in.operands) bends.need(operand), lines.need(operand);
  });
  for (const Value value : main.body.yields) shown.need(value);
  bends.run();
  lines.run();
  shown.run();
  for_each(main.body, found, [&](const Instruction& in, bool in_loop) {
    const Cut cut = cut_of(in.op);
    if (cut == Cut::none || cut == Cut::compare || !differs(in)) return;
    const bool is_unshown = cut == Cut::kink && found.forks[in.result()] && !shown[in.result()];
    if (is_unshown) found.forks[in.result()] = false;
    if (in.op == Op::fabs || is_unshown) found.bends[in.result()] = bends[in.result()];
    const bool may_crease = in.op == Op::fabs || cut != Cut::kink;
    found.creases[in.result()] =
        may_crease && lines[in.result()] && !(in_loop && is_of_noise(module, in.operands[0]));
  });
  found.any = std::ranges::find(found.forks, true) != found.forks.end();
  find_searches(main, found);
  found.rays.resize(main.values.size());
  for_each(main.body, found, [&](const Instruction& in, bool) {
    if (in.op == Op::external && is_ray(module, in) && differs(in))
      found.rays[in.results[0]] = found.any = true;
  });
  found.noises = find_noise(module, found, changes, lines);
  found.any_noise =
      found.noises.others || std::ranges::find(found.noises.told, true) != found.noises.told.end();
  found.bent = find_bent(module, found, changes);
  found.any_bent = std::ranges::find(found.bent, true) != found.bent.end();
  return found;
}

}  // namespace pse::antialias
