// Branches, loops, checks and calls. A branch is taken where any lane takes it, a loop turns while
// any lane turns; a mask keeps the results of the other lanes.
//
// Code that is reached from two places finds no values in registers: before a jump everything that
// is needed later goes to its row. What a region computes is not seen outside, so nothing is left
// to be stored at its end but its yields.
#include <algorithm>
#include <cstddef>

#include "codegen/first/function_code.h"
#include "codegen/kernel_call.h"

namespace pse::first {
namespace {

using ir::Op;

// Whether instructions of the region ask which lanes are active.
bool asks_for_mask(const ir::Region& region) {
  return std::ranges::any_of(region.body, [](const ir::Instruction& in) {
    return !in.regions.empty() || in.op == Op::call || in.op == Op::external ||
           in.op == Op::check || in.op == Op::array_load || in.op == Op::array_store ||
           in.op == Op::array_resize;
  });
}

}  // namespace

std::vector<Memory> FunctionCode::take_rows(std::size_t count) {
  std::vector<Memory> rows(count);
  for (Memory& row : rows) row = places_.take_row();
  return rows;
}

void FunctionCode::branch(const ir::Instruction& in) {
  const ir::Region &then = in.regions[0], &otherwise = in.regions[1];
  const bool has_else = !otherwise.body.empty() || !otherwise.yields.empty();
  const std::vector<Memory> rows = take_rows(in.results.size());
  const Memory then_mask = places_.take_row(), else_mask = places_.take_row();

  // Who goes where.
  const Ymm condition = places_.in_register(in.operands[0]);
  const Ymm lanes_then = places_.temporary();
  if (mask_) {
    code_.vector(op::and_ps, lanes_then, condition, *mask_);
  } else {
    code_.move(lanes_then, condition);
  }
  if (asks_for_mask(then)) code_.store(then_mask, lanes_then);
  if (has_else) {
    const Ymm lanes_else = places_.temporary();
    code_.vector(op::andnot_ps, lanes_else, condition, mask_ ? *mask_ : all(0xffffffffu));
    code_.store(else_mask, lanes_else);
  }
  code_.mask_bits(Gpr::rax, lanes_then);
  places_.release_operands();
  places_.store_all();
  places_.end_step();

  // One side.
  Label behind_then;
  const Mask outer = mask_;
  mask_ = then_mask;
  code_.test32(Gpr::rax);
  code_.jump(Assembler::When::equal, behind_then);
  region(then);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    code_.store(rows[i], places_.in_register(then.yields[i]));
    places_.unpin();
  }
  places_.end_step();
  forget_registers();
  code_.bind(behind_then);

  // The other.
  mask_ = else_mask;
  if (has_else) branch_else(in, else_mask, rows);
  mask_ = outer;
  for (std::size_t i = 0; i < rows.size(); ++i) places_.set_row(in.results[i], rows[i], true);
  places_.give_row(then_mask);
  places_.give_row(else_mask);
  places_.end_step();
}

void FunctionCode::branch_else(const ir::Instruction& in, const Memory& mask,
                               const std::vector<Memory>& rows) {
  const ir::Region& otherwise = in.regions[1];
  Label behind;
  const Ymm lanes_else = places_.temporary();
  code_.load(lanes_else, mask);
  code_.mask_bits(Gpr::rax, lanes_else);
  code_.test32(Gpr::rax);
  code_.jump(Assembler::When::equal, behind);
  places_.unpin();
  region(otherwise);
  for (std::size_t i = 0; i < rows.size(); ++i)
    blend_into(rows[i], places_.operand(otherwise.yields[i]), mask);
  forget_registers();
  code_.bind(behind);
}

// Lanes of `mask` get the value, the others keep what the row has.
void FunctionCode::blend_into(const Memory& row, const Operand& value, const Memory& mask) {
  const Ymm chosen = places_.temporary(), kept = places_.temporary();
  code_.load(chosen, mask);
  code_.load(kept, row);
  code_.blend(kept, kept, value, chosen);
  code_.store(row, kept);
  places_.unpin();
}

// Each carried value has a row, which the turn reads and the next turn finds changed where lanes
// went on.
void FunctionCode::loop(const ir::Instruction& in) {
  const ir::Region &head = in.regions[0], &body = in.regions[1];
  const std::vector<Memory> rows = take_rows(in.operands.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    code_.store(rows[i], places_.in_register(in.operands[i]));
    places_.unpin();
  }
  const Memory mask = places_.take_row();
  const Ymm start = places_.temporary();
  if (mask_) {
    code_.load(start, *mask_);
  } else {
    ones(start);
  }
  code_.store(mask, start);
  places_.release_operands();
  places_.store_all();
  places_.end_step();
  forget_registers();

  // The condition: who is still in.
  const Mask outer = mask_;
  mask_ = mask;
  Label turn, out;
  code_.bind(turn);
  for (std::size_t i = 0; i < rows.size(); ++i) places_.set_row(head.params[i], rows[i], false);
  region(head);
  const Ymm condition = places_.in_register(head.yields[0]);
  const Ymm still = places_.temporary();
  code_.vector(op::and_ps, still, condition, mask);
  code_.store(mask, still);
  code_.mask_bits(Gpr::rax, still);
  code_.test32(Gpr::rax);
  code_.jump(Assembler::When::equal, out);
  code_.compare_byte({cancel_flag}, 0);
  code_.jump(Assembler::When::not_equal, kernel_.leave);

  // A turn.
  for (std::size_t i = 0; i < rows.size(); ++i) {
    places_.set_row(body.params[i], rows[i], false);
    places_.hand_over(head.params[i], body.params[i]);
  }
  places_.end_step();
  region(body);
  next_turn(body, mask, rows);
  code_.jump(turn);
  forget_registers();
  code_.bind(out);
  mask_ = outer;
  for (std::size_t i = 0; i < rows.size(); ++i) places_.set_row(in.results[i], rows[i], true);
  places_.give_row(mask);
  places_.end_step();
}

// The rows as the next turn finds them. One that takes over another's value takes it from a copy:
// that other one may have changed before.
void FunctionCode::next_turn(const ir::Region& body, const Memory& mask,
                             const std::vector<Memory>& rows) {
  const auto is_moved = [&](std::size_t i) {
    return body.yields[i] != body.params[i] &&
           std::ranges::find(body.params, body.yields[i]) != body.params.end();
  };
  std::vector<Memory> copies(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!is_moved(i)) continue;
    copies[i] = places_.take_row();
    code_.store(copies[i], places_.in_register(body.yields[i]));
    places_.unpin();
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (body.yields[i] == body.params[i]) continue;
    blend_into(rows[i], is_moved(i) ? Operand(copies[i]) : places_.operand(body.yields[i]), mask);
    if (is_moved(i)) places_.give_row(copies[i]);
  }
}

// The first active lane that fails is noted, and the code returns.
void FunctionCode::check(const ir::Instruction& in) {
  const Ymm condition = places_.in_register(in.operands[0]);
  const Ymm failing = places_.temporary();
  code_.vector(op::andnot_ps, failing, condition, mask_ ? *mask_ : all(0xffffffffu));
  code_.mask_bits(Gpr::rax, failing);
  Label passed;
  code_.test32(Gpr::rax);
  code_.jump(Assembler::When::equal, passed);
  code_.lowest_bit(Gpr::rax, Gpr::rax);
  code_.add(Gpr::rax, sample_index);
  code_.store({call_base, offsetof(KernelCall, failed_sample)}, Gpr::rax);
  code_.store32({call_base, offsetof(KernelCall, failed_check)}, in.imm);
  code_.jump(kernel_.leave);
  code_.bind(passed);
}

// Arguments, results and the mask go through rows of the called function.
void FunctionCode::call(const ir::Instruction& in) {
  Callee& callee = kernel_.callees.at(static_cast<std::uint32_t>(in.imm));
  std::int32_t row = callee.params;
  for (const ir::Value operand : in.operands) {
    code_.store({Places::frame, row}, places_.in_register(operand));
    places_.unpin();
    row += row_size;
  }
  const Ymm active = places_.temporary();
  if (mask_) {
    code_.load(active, *mask_);
  } else {
    ones(active);
  }
  code_.store({Places::frame, callee.mask}, active);
  places_.release_operands();
  places_.store_all();
  forget_registers();
  code_.call(callee.entry);
  from_rows(in.results, callee.results);
}

}  // namespace pse::first
