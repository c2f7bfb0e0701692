// The course of each output, by its form and by what it is made of.
#include "antialias/courses.h"

#include <algorithm>

#include "antialias/dither.h"
#include "antialias/forms.h"
#include "passes/slice.h"

namespace pse::antialias {
namespace {

using ir::Op;
using ir::Region;
using ir::Value;

// Whether something in the region that the slice needs looks pixels up.
bool reads_stored(const ir::Module& module, const passes::Slice& slice, const Region& region) {
  return std::ranges::any_of(region.body, [&](const ir::Instruction& in) {
    const auto is_needed = [&](Value result) { return slice[result]; };
    if (in.op == Op::external && std::ranges::any_of(in.results, is_needed))
      return module.externals[static_cast<std::size_t>(in.imm)].name.starts_with("texture");
    return std::ranges::any_of(
        in.regions, [&](const Region& inner) { return reads_stored(module, slice, inner); });
  });
}

}  // namespace

std::vector<Course> find_courses(const ir::Module& module, const Decisions& decisions) {
  const std::vector<Form> forms = find_forms(module, decisions, Folds::unseen);
  const std::vector<bool> whole = find_dither(module, false);
  std::vector<Course> courses;
  for (const Value value : module.main().body.yields) {
    passes::Slice slice(module.main());
    slice.need(value);
    slice.run();
    const bool is_fixed = whole[value] || reads_stored(module, slice, module.main().body);
    courses.push_back(is_fixed                           ? Course::fixed
                      : forms[value].kind > Kind::linear ? Course::bent
                                                         : Course::even);
  }
  return courses;
}

}  // namespace pse::antialias
