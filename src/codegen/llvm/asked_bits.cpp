// One walk from the last instruction to the first: uses come before what they use.
#include "codegen/llvm/asked_bits.h"

#include <optional>
#include <ranges>

namespace pse {
namespace {

using ir::Op;

constexpr std::uint32_t all = 0xffffffffu;

class AskedBits {
 public:
  AskedBits(const ir::Module& module, const ir::Function& function)
      : module_(module), constants_(function.values.size()), asked_(function.values.size()) {
    find_constants(function.body);
    region(function.body);
  }

  std::vector<std::uint32_t> take() { return std::move(asked_); }

 private:
  void find_constants(const ir::Region& r) {
    for (const ir::Instruction& in : r.body) {
      if (in.op == Op::const_i32) constants_[in.result()] = static_cast<std::uint32_t>(in.imm);
      for (const ir::Region& inner : in.regions) find_constants(inner);
    }
  }

  void region(const ir::Region& r) {
    for (const ir::Value value : r.yields) asked_[value] = all;
    for (const ir::Instruction& in : r.body | std::views::reverse) {
      for (const ir::Region& inner : in.regions) region(inner);
      for (std::size_t i = 0; i < in.operands.size(); ++i)
        asked_[in.operands[i]] |= asked_of(in, i);
    }
  }

  // The bits of operand i that the instruction looks at.
  std::uint32_t asked_of(const ir::Instruction& in, std::size_t i) const {
    const auto index = static_cast<std::size_t>(in.imm);
    switch (in.op) {
      case Op::table_f32:
        return static_cast<std::uint32_t>(module_.float_tables[index].entries.size() - 1);
      case Op::table_i32:
        return static_cast<std::uint32_t>(module_.int_tables[index].entries.size() - 1);
      case Op::select:
        return i == 0 ? all : asked_[in.result()];
      case Op::ishr:
        if (const auto by = constants_[in.operands[1]]; i == 0 && by && *by < 32)
          return asked_[in.result()] << *by;
        return all;
      case Op::iand:
        if (const auto mask = constants_[in.operands[1 - i]]) return asked_[in.result()] & *mask;
        return asked_[in.result()];
      default:
        return all;
    }
  }

  const ir::Module& module_;
  std::vector<std::optional<std::uint32_t>> constants_;
  std::vector<std::uint32_t> asked_;
};

}  // namespace

std::vector<std::uint32_t> find_asked_bits(const ir::Module& module, const ir::Function& function) {
  return AskedBits(module, function).take();
}

}  // namespace pse
