// Where the values of a function are while its code is written: in one of sixteen vector registers,
// in a row of the frame, or made anew from a constant or a uniform input. Registers are given as
// values need them, and what was used longest ago goes to its row; rows are used again when their
// values are dead (lifetimes.h). Between function_code.cpp and the assembler.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codegen/first/assembler.h"
#include "codegen/first/lifetimes.h"

namespace pse::first {

// Bytes of one row: eight lanes.
inline constexpr std::int32_t row_size = 32;

class Places {
 public:
  static constexpr Gpr frame = Gpr::rbx, uniforms = Gpr::r13;

  // Rows are taken from `frame_size` on.
  Places(const ir::Function& function, Assembler& assembler, std::int32_t frame_size);

  // ---- Rows ----
  Memory take_row();
  void give_row(const Memory& row) { free_rows_.push_back(row.disp); }
  // The end of the rows that were ever taken.
  std::int32_t frame_end() const { return frame_end_; }

  // ---- Values that are nowhere yet ----
  void set_constant(ir::Value value, const Memory& row) { places_[value].constant = row.disp; }
  void set_uniform(ir::Value value, std::int32_t input) { places_[value].uniform = input; }
  // The value stands in `row`; `owned`: the row is given back with the value.
  void set_row(ir::Value value, const Memory& row, bool owned);
  // The register of `from`, if it has one, holds `to` from here on: they are the same.
  void hand_over(ir::Value from, ir::Value to);

  // ---- Within one instruction: registers used stay until end_step() ----
  // The value in a register.
  Ymm in_register(ir::Value value);
  // The value as last operand; a register where it is needed again.
  Operand operand(ir::Value value);
  // A register of the value alone that the instruction may overwrite, with its present contents.
  Ymm copy(ir::Value value);
  // A register for a result; the value need not be stored yet.
  Ymm define(ir::Value value);
  // Makes the register that copy() or temporary() gave the value's.
  void define(ir::Value value, Ymm in);
  Ymm temporary();
  // Exactly this register, whose value goes elsewhere.
  void take_register(Ymm reg);
  bool has_register(ir::Value value) const { return places_[value].reg >= 0; }
  bool is_constant(ir::Value value) const { return places_[value].constant >= 0; }
  // Where a constant stands, from Constants::base; -1: it is none.
  std::int32_t constant_row(ir::Value value) const { return places_[value].constant; }
  // The value is not needed after this step's operands are read.
  bool dies(ir::Value value) const { return lifetimes_.last_use[value] <= 2 * step_; }
  // Registers used so far may go elsewhere: between the parts of an instruction with many operands.
  void unpin() { pinned_ = 0; }

  // ---- Steps ----
  // Between the operands of a step and its results: the registers of values that die are free.
  void release_operands() { release(2 * step_); }
  void end_step();

  // ---- Where code joins ----
  // Everything needed later is in its row.
  void store_all();
  // No register holds anything: behind calls, at places that jumps go to.
  void forget_registers();

 private:
  struct Place {
    std::int32_t row = -1, constant = -1, uniform = -1;
    std::int8_t reg = -1;
    bool stored = false, owned = false;
  };
  static constexpr ir::Value nobody = ir::no_value;

  bool remade(const Place& place) const { return place.constant >= 0 || place.uniform >= 0; }
  Ymm free_register();
  void evict(Ymm reg);
  void store(ir::Value value);
  void assign(ir::Value value, Ymm reg);
  void release(std::int32_t time);
  void touch(Ymm reg);

  Assembler& code_;
  Lifetimes lifetimes_;
  std::vector<Place> places_;
  std::array<ir::Value, 16> holds_{};
  std::array<std::uint32_t, 16> touched_{};
  std::uint32_t pinned_ = 0, clock_ = 0;
  std::vector<std::int32_t> free_rows_, freed_rows_;  // freed: in this step
  std::int32_t frame_end_;
  std::int32_t step_ = 0;
  std::size_t released_ = 0;  // values of Lifetimes::order that are gone
};

}  // namespace pse::first
