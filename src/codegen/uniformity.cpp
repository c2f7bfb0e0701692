// Marks values as varying until nothing changes. A parameter of a loop with a varying condition can
// still be uniform inside the loop, since all samples that are active there have run it equally
// often; its result is varying.
#include "codegen/uniformity.h"

#include <algorithm>

namespace pse {
namespace {

using ir::Op;

class Finder {
 public:
  Finder(const ir::Module& module, const ir::Function& function, Uniformity& result)
      : module_(module), function_(function), result_(result) {}

  void run() {
    do {
      changed_ = false;
      region(function_.body, false);
    } while (changed_);
  }

 private:
  bool varying(ir::Value value) const { return result_.varying[value]; }

  void mark(ir::Value value, bool is_varying) {
    if (!is_varying || result_.varying[value]) return;
    result_.varying[value] = true;
    changed_ = true;
  }

  void mark_length(std::size_t array, bool is_varying) {
    if (!is_varying || result_.varying_length[array]) return;
    result_.varying_length[array] = true;
    changed_ = true;
  }

  void region(const ir::Region& r, bool in_varying_control) {
    for (const ir::Instruction& instruction : r.body) visit(instruction, in_varying_control);
  }

  void visit(const ir::Instruction& in, bool in_varying_control) {
    const bool any = std::ranges::any_of(in.operands, [&](ir::Value v) { return varying(v); });
    const auto index = static_cast<std::size_t>(in.imm);
    const auto is_sample = [&] { return function_.arrays[index].rate == ir::Rate::sample; };
    switch (in.op) {
      case Op::input:
        mark(in.result(), module_.inputs[index].rate == ir::Rate::sample);
        break;
      case Op::array_load:
        mark(in.result(), any || is_sample());
        break;
      case Op::array_length:
        mark(in.result(), is_sample() && result_.varying_length[index]);
        break;
      case Op::array_resize:
        mark_length(index, is_sample() && (any || in_varying_control));
        break;
      case Op::if_:
        visit_if(in, in_varying_control);
        break;
      case Op::loop:
        visit_loop(in, in_varying_control);
        break;
      default:
        for (const ir::Value value : in.results) mark(value, any);
    }
  }

  void visit_if(const ir::Instruction& in, bool in_varying_control) {
    const bool split = varying(in.operands[0]);
    for (const ir::Region& r : in.regions) region(r, in_varying_control || split);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      const ir::Value a = in.regions[0].yields[i], b = in.regions[1].yields[i];
      mark(in.results[i], (split && a != b) || varying(a) || varying(b));
    }
  }

  void visit_loop(const ir::Instruction& in, bool in_varying_control) {
    const ir::Region &head = in.regions[0], &body = in.regions[1];
    for (std::size_t i = 0; i < head.params.size(); ++i)
      mark(head.params[i], varying(in.operands[i]));
    region(head, in_varying_control || varying(head.yields[0]));
    const bool split = varying(head.yields[0]);
    for (std::size_t i = 0; i < head.params.size(); ++i) {
      if (!body.params.empty()) mark(body.params[i], varying(head.params[i]));
    }
    region(body, in_varying_control || split);
    for (std::size_t i = 0; i < head.params.size(); ++i) {
      mark(head.params[i], varying(body.yields[i]));
      mark(in.results[i], split || varying(head.params[i]));
    }
  }

  const ir::Module& module_;
  const ir::Function& function_;
  Uniformity& result_;
  bool changed_ = false;
};

bool has_varying_loop(const ir::Region& region, const Uniformity& uniformity) {
  return std::ranges::any_of(region.body, [&](const ir::Instruction& in) {
    if (in.op == Op::loop && uniformity.varying[in.regions[0].yields[0]]) return true;
    return std::ranges::any_of(
        in.regions, [&](const ir::Region& r) { return has_varying_loop(r, uniformity); });
  });
}

}  // namespace

Uniformity all_uniform(const ir::Function& function) {
  return {std::vector<bool>(function.values.size(), false),
          std::vector<bool>(function.arrays.size(), false)};
}

Uniformity find_uniformity(const ir::Module& module, const ir::Function& function,
                           const std::vector<bool>& varying_params) {
  Uniformity result = all_uniform(function);
  for (std::size_t i = 0; i < varying_params.size(); ++i) {
    result.varying[function.body.params[i]] = varying_params[i];
  }
  Finder(module, function, result).run();
  return result;
}

bool has_varying_loops(const passes::SplitModule& split) {
  // What is called may be called with anything.
  for (std::size_t f = 0; f < split.module.functions.size(); ++f) {
    const ir::Function& function = split.module.functions[f];
    const std::vector<bool> varying(function.body.params.size(), true);
    if (f != split.frame &&
        has_varying_loop(function.body, find_uniformity(split.module, function, varying)))
      return true;
  }
  return false;
}

}  // namespace pse
