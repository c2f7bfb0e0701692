// A walk through the main function with what is known of each value; loops until nothing changes.
#include "antialias/courses.h"

#include <algorithm>

#include "antialias/dither.h"
#include "passes/slice.h"

namespace pse::antialias {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// Of a value between two edges, the more the less is known.
enum class Bending : std::uint8_t { constant, linear, bent };

class Bendings {
 public:
  Bendings(const ir::Module& module, const Decisions& decisions)
      : module_(module),
        main_(module.main()),
        decisions_(decisions),
        kinds_(main_.values.size(), Bending::constant) {}

  void find() {
    do {
      changed_ = false;
      walk(main_.body);
    } while (changed_);
  }
  Bending operator[](Value value) const { return kinds_[value]; }

 private:
  void set(Value value, Bending kind) {
    if (main_.values[value].rate != ir::Rate::sample || kind <= kinds_[value]) return;
    kinds_[value] = kind;
    changed_ = true;
  }

  void walk(const Region& region) {
    for (const Instruction& in : region.body) {
      for (const Region& inner : in.regions) walk(inner);
      if (in.op == Op::if_)
        for (std::size_t k = 0; k < in.results.size(); ++k)
          set(in.results[k],
              std::max(kinds_[in.regions[0].yields[k]], kinds_[in.regions[1].yields[k]]));
      else if (in.op == Op::loop)
        turn(in);
      else
        for (const Value result : in.results) set(result, kind_of(in));
    }
  }

  // What turns hand on to each other; of a search nothing is known, since its turns are no edges.
  void turn(const Instruction& in) {
    const Region &head = in.regions[0], &body = in.regions[1];
    for (std::size_t k = 0; k < in.results.size(); ++k) {
      const Bending kind = decisions_.is_search(in)
                               ? Bending::bent
                               : std::max(kinds_[in.operands[k]], kinds_[body.yields[k]]);
      for (const Value value : {head.params[k], body.params[k], in.results[k]}) set(value, kind);
    }
  }

  Bending kind_of(const Instruction& in) const {
    const auto kind = [&](std::size_t k) { return kinds_[in.operands[k]]; };
    const auto product = [](Bending a, Bending b) {
      return a == Bending::constant ? b : b == Bending::constant ? a : Bending::bent;
    };
    Bending most = Bending::constant;
    for (const Value operand : in.operands) most = std::max(most, kinds_[operand]);
    switch (in.op) {
      case Op::input:  // places, normals, depths are data
        return Bending::linear;
      case Op::external:
        return most == Bending::constant ? most : is_data(in) ? Bending::linear : Bending::bent;
      case Op::slope:
        return most == Bending::bent ? Bending::bent : Bending::constant;
      case Op::fadd:
      case Op::fsub:
      case Op::fneg:
        return most;
      case Op::fmin:
      case Op::fmax:  // which of the two is told by the path
        return most;
      case Op::fmul:
        return product(kind(0), kind(1));
      case Op::fma:
        return std::max(product(kind(0), kind(1)), kind(2));
      case Op::fdiv:
        return kind(1) == Bending::constant ? kind(0) : Bending::bent;
      case Op::select:
        return std::max(kind(1), kind(2));
      case Op::array_load:
      case Op::array_length:
        return Bending::bent;
      default:
        // Where an answer or a whole number changes there is an edge.
        if (cut_of(in.op) != Cut::none && cut_of(in.op) != Cut::kink) return Bending::constant;
        return most == Bending::constant ? most : Bending::bent;
    }
  }

  // Where rays end, as the stream brings it for the first ray.
  bool is_data(const Instruction& in) const {
    const std::string& name = module_.externals[static_cast<std::size_t>(in.imm)].name;
    return name.starts_with("trace") || name.starts_with("visible");
  }

  const ir::Module& module_;
  const ir::Function& main_;
  const Decisions& decisions_;
  std::vector<Bending> kinds_;
  bool changed_ = false;
};

// Whether something in the region that the slice needs looks pixels up.
bool reads_stored(const ir::Module& module, const passes::Slice& slice, const Region& region) {
  return std::ranges::any_of(region.body, [&](const Instruction& in) {
    const auto is_needed = [&](Value result) { return slice[result]; };
    if (in.op == Op::external && std::ranges::any_of(in.results, is_needed))
      return module.externals[static_cast<std::size_t>(in.imm)].name.starts_with("texture");
    return std::ranges::any_of(
        in.regions, [&](const Region& inner) { return reads_stored(module, slice, inner); });
  });
}

}  // namespace

std::vector<Course> find_courses(const ir::Module& module, const Decisions& decisions) {
  Bendings kinds(module, decisions);
  kinds.find();
  const std::vector<bool> whole = find_dither(module, false);
  std::vector<Course> courses;
  for (const Value value : module.main().body.yields) {
    passes::Slice slice(module.main());
    slice.need(value);
    slice.run();
    const bool is_fixed = whole[value] || reads_stored(module, slice, module.main().body);
    courses.push_back(is_fixed                        ? Course::fixed
                      : kinds[value] == Bending::bent ? Course::bent
                                                      : Course::even);
  }
  return courses;
}

}  // namespace pse::antialias
