// Twice by the rates of values (passes/rates): with px and py alone changing from sample to sample,
// what depends on them; with the chances that are made of these alone changing, what depends on
// chance. In between: how much values change from pixel to pixel, as far as constants tell.
#include "antialias/dither.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "antialias/decisions.h"
#include "passes/passes.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
// Whole numbers of what changes by this from pixel to pixel change at every pixel.
constexpr float every_pixel = 1;

bool is_pixel(const ir::Input& input) { return input.name == "px" || input.name == "py"; }

// Which values differ from sample to sample once rates are assigned.
std::vector<bool> differing(ir::Module& module) {
  passes::assign_rates(module);
  std::vector<bool> found;
  for (const ir::ValueInfo& value : module.main().values)
    found.push_back(value.rate == ir::Rate::sample);
  return found;
}

// Marks the chances: instructions whose results are what dither is made of.
class Chances {
 public:
  Chances(const ir::Module& module, const std::vector<bool>& of_pixels, bool hashes)
      : module_(module),
        of_pixels_(of_pixels),
        hashes_(hashes),
        change_(of_pixels.size(), unknown),
        constant_(of_pixels.size(), unknown),
        whole_of_(of_pixels.size(), ir::no_value) {}

  // In place: each becomes an input of its own.
  bool find(Region& region, std::int32_t input) {
    bool found = false;
    for (Instruction& in : region.body) {
      for (Region& inner : in.regions) found |= find(inner, input);
      if (in.op == Op::const_f32) constant_[in.result()] = in.imm_f32();
      for (const Value result : in.results)
        change_[result] = of_pixels_[result] ? change_of(in) : 0;
      if (!is_chance(in)) continue;
      whole_of_[in.result()] = in.operands[0];
      in.op = Op::input, in.imm = input;
      in.operands.clear();
      found = true;
    }
    return found;
  }

 private:
  bool is_chance(const Instruction& in) const {
    if (in.operands.empty() || !of_pixels_[in.operands[0]]) return false;
    const Cut cut = cut_of(in.op);
    const bool is_step = cut == Cut::whole || cut == Cut::half;
    const float change = change_[in.operands[0]];
    if (!hashes_) return is_step && change == every_pixel;
    // A hash, but of whole numbers that stay from pixel to pixel, or what is left of a number
    // without its whole part.
    return (in.op == Op::f2bits && change != 0) ||
           (in.op == Op::fsub && whole_of_[in.operands[1]] == in.operands[0]) ||
           (is_step && change >= every_pixel);
  }

  // At most how much a result changes from pixel to pixel, steps aside.
  float change_of(const Instruction& in) const {
    const auto change = [&](std::size_t k) { return change_[in.operands[k]]; };
    const auto size = [&](std::size_t k) { return std::abs(constant_[in.operands[k]]); };
    const auto product = [&](std::size_t a, std::size_t b) {
      if (change(a) == 0 && change(b) == 0) return 0.0f;
      return change(a) == 0 ? change(b) * size(a) : change(b) == 0 ? change(a) * size(b) : unknown;
    };
    switch (in.op) {
      case Op::input:
        return is_pixel(module_.inputs[static_cast<std::size_t>(in.imm)]) ? 1 : 0;
      case Op::fadd:
      case Op::fsub:
        return change(0) + change(1);
      case Op::fmul:
        return product(0, 1);
      case Op::fma:
        return product(0, 1) + change(2);
      case Op::fdiv:
        return change(1) == 0 ? change(0) / size(1) : unknown;
      case Op::fneg:
      case Op::fabs:
        return change(0);
      case Op::ffloor:
      case Op::fceil:
      case Op::ftrunc:
      case Op::fround:
      case Op::f2i:
        return change(0) < every_pixel ? 0 : unknown;
      case Op::call: {
        const std::string& name = module_.functions[static_cast<std::size_t>(in.imm)].name;
        return name == "sin" || name == "cos" ? change(0) : unknown;
      }
      default:
        return unknown;
    }
  }

  const ir::Module& module_;
  const std::vector<bool>& of_pixels_;
  const bool hashes_;
  std::vector<float> change_, constant_;
  std::vector<Value> whole_of_;  // of a chance: what it is the whole part of
};

}  // namespace

std::vector<bool> find_dither(const ir::Module& module, bool hashes) {
  ir::Module of_pixels = module;
  if (std::ranges::none_of(module.inputs, is_pixel))
    return std::vector<bool>(module.main().values.size());
  for (ir::Input& input : of_pixels.inputs)
    input.rate = is_pixel(input) ? ir::Rate::sample : ir::Rate::frame;
  const std::vector<bool> differs = differing(of_pixels);

  ir::Module of_chance = module;
  for (ir::Input& input : of_chance.inputs) input.rate = ir::Rate::frame;
  of_chance.inputs.push_back({"$chance", ir::Rate::sample});
  const auto chance = static_cast<std::int32_t>(module.inputs.size());
  if (!Chances(module, differs, hashes).find(of_chance.main().body, chance))
    return std::vector<bool>(module.main().values.size());
  // What is gone with the chances' operands was wanted for them alone.
  passes::remove_dead(of_chance);
  std::vector<bool> found = differing(of_chance);
  const std::vector<bool> before = defined_values(module.main()),
                          after = defined_values(of_chance.main());
  for (std::size_t value = 0; value < found.size(); ++value)
    if (before[value] && !after[value]) found[value] = true;
  return found;
}

}  // namespace pse::antialias
