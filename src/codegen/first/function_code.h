// Writes the code of one function: straight instructions, branches and loops under masks, calls.
// Part of kernel_code.cpp's flow.
//
// A boolean is a lane of all ones or all zeros. Where only some lanes may be active, `mask_` says
// which: it is a row of the frame. Lanes that are not active compute anything, without effects.
#pragma once

#include <optional>
#include <span>

#include "codegen/first/kernel_code.h"
#include "codegen/first/places.h"
#include "codegen/uniformity.h"

namespace pse::first {

// Registers that hold the same all the time.
inline constexpr Gpr call_base = Gpr::r12, sample_index = Gpr::r14, cancel_flag = Gpr::r15;
// The index that the last loads of an array had in common for all lanes.
inline constexpr Gpr common_index = Gpr::r10;

class FunctionCode {
 public:
  FunctionCode(KernelState& kernel, const ir::Function& function)
      : kernel_(kernel),
        code_(kernel.code),
        function_(function),
        places_(function, kernel.code, kernel.frame_size) {}

  // The sample function, for the lanes at sample_index.
  void write_samples();
  // A called function.
  void write_called(Callee& callee);

 private:
  using Mask = std::optional<Memory>;  // none: all lanes are active

  // function_code.cpp: straight instructions
  void region(const ir::Region& region);
  void instruction(const ir::Instruction& in);
  bool straight(const ir::Instruction& in);
  void input(const ir::Instruction& in);
  void binary(const VectorOp& op, const ir::Instruction& in, bool commutes = false, int byte = -1);
  void swapped(const VectorOp& op, const ir::Instruction& in);
  void unary(const VectorOp& op, const ir::Instruction& in, int byte = -1);
  void with_constant(const VectorOp& op, const ir::Instruction& in, std::uint32_t bits);
  void invert(const ir::Instruction& in);
  void fused(const ir::Instruction& in);
  void select(const ir::Instruction& in);
  void table(std::span<const std::uint32_t> entries, const ir::Instruction& in);
  void byte_lookup(const ir::Instruction& in);

  // control_code.cpp: what jumps
  void branch(const ir::Instruction& in);
  void branch_else(const ir::Instruction& in, const Memory& mask, const std::vector<Memory>& rows);
  void loop(const ir::Instruction& in);
  void next_turn(const ir::Region& body, const Memory& mask, const std::vector<Memory>& rows);
  void blend_into(const Memory& row, const Operand& value, const Memory& mask);
  void check(const ir::Instruction& in);
  void call(const ir::Instruction& in);
  std::vector<Memory> take_rows(std::size_t count);

  // effect_code.cpp: memory and the host
  void begin_arrays();
  bool is_sample_array(const ir::Instruction& in) const;
  void array_load(const ir::Instruction& in);
  void array_load_common(const ir::Instruction& in);
  void find_common_index(ir::Value index);
  void array_length(const ir::Instruction& in);
  void array_store(const ir::Instruction& in);
  void array_store_at(const ir::Instruction& in, std::int32_t element);
  void array_resize(const ir::Instruction& in);
  void external(const ir::Instruction& in);
  void outputs();
  void to_block(std::span<const ir::Value> values);
  void from_rows(std::span<const ir::Value> values, std::int32_t first);
  void mask_address(Gpr to);
  void forget_registers();
  void array_address(Gpr to, const ir::Instruction& in, std::int32_t component);
  template <class F>
  void call_host(F* function);

  const ir::Array& array_of(const ir::Instruction& in) const {
    return function_.arrays[static_cast<std::size_t>(in.imm)];
  }
  Memory all(std::uint32_t bits) { return kernel_.constants.all(bits); }
  void ones(Ymm to) { code_.vector(op::equal_d, to, to, to); }

  KernelState& kernel_;
  Assembler& code_;
  const ir::Function& function_;
  Places places_;
  Mask mask_;
  std::optional<Uniformity> uniformity_;      // where it is asked for
  ir::Value in_common_index_ = ir::no_value;  // whose index common_index is
};

}  // namespace pse::first
