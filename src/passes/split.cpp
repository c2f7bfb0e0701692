// Cuts the program by rate (pipeline.h): the frame function does what is the same for all samples
// of a frame, the program reads its results as inputs.
//
// Both are copies of the program from which the other's part is left out, so a loop or an if with
// work of both rates stands in both. A value goes through a slot if the frame function has exactly
// one of it: it is of rate frame, runs under control of rate frame, and is not in a loop.
#include <algorithm>
#include <string>
#include <utility>

#include "ir/reads.h"
#include "passes/passes.h"
#include "passes/rewrite.h"
#include "passes/split_functions.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Rate;
using ir::Region;
using ir::Value;

constexpr int max_rounds = 6;

// Numbers instructions in program order, and tells which arrays of rate frame the sample reads
// before the frame has written them for the last time.
class ReadsTooEarly {
 public:
  explicit ReadsTooEarly(const Function& program)
      : position_(program.values.size(), 0), last_write_(program.arrays.size(), 0) {
    number(program.body, false);
    for (const std::size_t array : open_writes_) last_write_[array] = next_;
  }

  // Marks such arrays in `of_sample`; says whether there are any.
  bool find(const Function& sample, std::vector<bool>& of_sample) const {
    bool found = false;
    find(sample, sample.body, of_sample, found);
    return found;
  }

 private:
  // A write in a loop counts as happening at the end of the outermost loop around it.
  void number(const Region& region, bool in_loop) {
    for (const Instruction& in : region.body) {
      ++next_;
      if (reads_array(in.op)) position_[in.result()] = next_;
      if (writes_array(in.op)) {
        if (in_loop) open_writes_.push_back(static_cast<std::size_t>(in.imm));
        last_write_[static_cast<std::size_t>(in.imm)] = next_;
      }
      const bool is_outermost_loop = in.op == Op::loop && !in_loop;
      for (const Region& inner : in.regions) number(inner, in_loop || in.op == Op::loop);
      if (!is_outermost_loop) continue;
      ++next_;
      for (const std::size_t array : open_writes_) last_write_[array] = next_;
      open_writes_.clear();
    }
  }

  void find(const Function& sample, const Region& region, std::vector<bool>& of_sample,
            bool& found) const {
    for (const Instruction& in : region.body) {
      for (const Region& inner : in.regions) find(sample, inner, of_sample, found);
      const auto array = static_cast<std::size_t>(in.imm);
      if (!reads_array(in.op) || of_sample[array] || position_[in.result()] > last_write_[array])
        continue;
      of_sample[array] = true;
      found = true;
    }
  }

  std::vector<std::uint32_t> position_;    // of the loads, by result
  std::vector<std::uint32_t> last_write_;  // per array
  std::vector<std::size_t> open_writes_;   // arrays written in the outermost loop being walked
  std::uint32_t next_ = 0;
};

void drop_unused(Function& function, const std::vector<bool>& observed = {}) {
  // remove_dead takes a module; this one holds only the function.
  ir::Module alone;
  alone.functions.push_back(std::move(function));
  remove_dead(alone, {.arrays = false, .functions = false, .observed = observed});
  function = std::move(alone.functions[0]);
}

void find_arrays_read(const Region& region, std::vector<bool>& read) {
  for (const Instruction& in : region.body) {
    if (reads_array(in.op)) read[static_cast<std::size_t>(in.imm)] = true;
    for (const Region& inner : in.regions) find_arrays_read(inner, read);
  }
}

void renumber_inputs(Region& region, const std::vector<std::int32_t>& number) {
  for (Instruction& in : region.body) {
    if (in.op == Op::input) in.imm = number[static_cast<std::size_t>(in.imm)];
    for (Region& inner : in.regions) renumber_inputs(inner, number);
  }
}

}  // namespace

void remove_dead(SplitModule& split) {
  Function& sample = split.module.main();
  drop_unused(sample);
  std::vector<bool> observed(sample.arrays.size(), false);
  find_arrays_read(sample.body, observed);
  drop_unused(split.module.functions[split.frame], observed);
}

void assign_rates(SplitModule& split) {
  for (Function& function : split.module.functions) {
    std::vector<bool> of_sample;
    for (const ir::Array& array : function.arrays) of_sample.push_back(array.rate == Rate::sample);
    assign_rates(split.module, function, of_sample);
  }
}

SplitModule split_nothing(ir::Module module) {
  SplitModule result;
  result.first_slot = static_cast<std::uint32_t>(module.inputs.size());
  result.frame = static_cast<std::uint32_t>(module.functions.size());
  for (ir::Array& array : module.main().arrays) array.rate = Rate::sample;
  Function frame{.name = "frame", .arrays = module.main().arrays};
  module.functions.push_back(std::move(frame));
  result.module = std::move(module);
  return result;
}

SplitModule split(ir::Module module) {
  const std::size_t first_slot = module.inputs.size();
  Function& program = module.main();

  // Arrays start as the frame's and become the sample's until each is read only behind its last
  // write.
  std::vector<bool> of_sample(program.arrays.size(), false);
  const ReadsTooEarly too_early(program);
  SampleFunction sample;
  for (int round = 1;; ++round) {
    assign_rates(module, program, of_sample);
    sample = cut_sample_function(program, first_slot);
    drop_unused(sample.function);
    if (!too_early.find(sample.function, of_sample)) break;
    // One array's change can be the next one's reason; a long chain of them is not worth the time.
    if (round == max_rounds) of_sample.assign(of_sample.size(), true);
  }

  // Only the slots that the sample still reads are filled.
  std::vector<bool> used(first_slot + sample.candidates.size(), false);
  ir::mark_inputs_read(sample.function.body, used);
  std::vector<std::int32_t> number(used.size());
  std::vector<Value> slots;
  for (std::size_t i = 0; i < used.size(); ++i) {
    number[i] = static_cast<std::int32_t>(i < first_slot ? i : first_slot + slots.size());
    if (i < first_slot || !used[i]) continue;
    module.inputs.push_back({"$slot." + std::to_string(slots.size()), Rate::frame});
    slots.push_back(sample.candidates[i - first_slot]);
  }
  renumber_inputs(sample.function.body, number);

  SplitModule result;
  result.first_slot = static_cast<std::uint32_t>(first_slot);
  result.frame = static_cast<std::uint32_t>(module.functions.size());
  Function frame = cut_frame_function(program, slots);
  std::vector<bool> observed(program.arrays.size(), false);
  find_arrays_read(sample.function.body, observed);
  drop_unused(frame, observed);
  module.main() = std::move(sample.function);
  module.functions.push_back(std::move(frame));
  result.module = std::move(module);

  assign_rates(result);
  return result;
}

}  // namespace pse::passes
