// Straight instructions: each operator of ir/ops.h as one or a few instructions of AVX2.
#include "codegen/first/function_code.h"

#include <cstddef>

#include "codegen/kernel_call.h"

namespace pse::first {

using ir::Op;

namespace {

constexpr std::uint32_t sign = 0x80000000u, all_ones = 0xffffffffu;
// Kinds of comparison, quiet and false for NaN but for the second: Intel's manual, CMPPS.
constexpr int equal = 0, not_equal = 4, below = 0x11, below_or_equal = 0x12;
// Rounding modes, without the report of inexactness.
constexpr int to_even = 8, down = 9, up = 10, to_zero = 11;

}  // namespace

void FunctionCode::region(const ir::Region& region) {
  for (const ir::Instruction& in : region.body) instruction(in);
}

void FunctionCode::instruction(const ir::Instruction& in) {
  switch (in.op) {
    case Op::if_:
      return branch(in);
    case Op::loop:
      return loop(in);
    case Op::call:
      call(in);
      break;
    case Op::external:
      external(in);
      break;
    case Op::check:
      check(in);
      break;
    case Op::array_load:
      array_load(in);
      break;
    case Op::array_store:
      array_store(in);
      break;
    case Op::array_length:
      array_length(in);
      break;
    case Op::array_resize:
      array_resize(in);
      break;
    default:
      if (!straight(in)) kernel_.refused = "an operator";
  }
  places_.end_step();
}

bool FunctionCode::straight(const ir::Instruction& in) {
  const ir::Module& module = kernel_.split.module;
  const auto index = static_cast<std::size_t>(in.imm);
  switch (in.op) {
    case Op::const_f32:
    case Op::const_i32:
      return places_.set_constant(in.result(), all(static_cast<std::uint32_t>(in.imm))), true;
    case Op::const_bool:
      return places_.set_constant(in.result(), all(in.imm != 0 ? all_ones : 0)), true;
    case Op::slope:
      return places_.set_constant(in.result(), all(0)), true;
    case Op::input:
      return input(in), true;
    case Op::fadd:
      return binary(op::add_ps, in, true), true;
    case Op::fsub:
      return binary(op::sub_ps, in), true;
    case Op::fmul:
      return binary(op::mul_ps, in, true), true;
    case Op::fdiv:
      return binary(op::div_ps, in), true;
    case Op::fma:
      return fused(in), true;
    case Op::fneg:
      return with_constant(op::xor_ps, in, sign), true;
    case Op::fabs:
      return with_constant(op::and_ps, in, ~sign), true;
    case Op::fsqrt:
      return unary(op::sqrt_ps, in), true;
    case Op::fmin:
      return binary(op::min_ps, in), true;
    case Op::fmax:
      return binary(op::max_ps, in), true;
    case Op::ffloor:
      return unary(op::round_ps, in, down), true;
    case Op::fceil:
      return unary(op::round_ps, in, up), true;
    case Op::ftrunc:
      return unary(op::round_ps, in, to_zero), true;
    case Op::fround:
      return unary(op::round_ps, in, to_even), true;
    case Op::feq:
      return binary(op::compare_ps, in, true, equal), true;
    case Op::fne:
      return binary(op::compare_ps, in, true, not_equal), true;
    case Op::flt:
      return binary(op::compare_ps, in, false, below), true;
    case Op::fle:
      return binary(op::compare_ps, in, false, below_or_equal), true;
    case Op::iadd:
      return binary(op::add_d, in, true), true;
    case Op::isub:
      return binary(op::sub_d, in), true;
    case Op::imul:
      return binary(op::mul_d, in, true), true;
    case Op::iand:
    case Op::band:
      return binary(op::and_ps, in, true), true;
    case Op::ior:
    case Op::bor:
      return binary(op::or_ps, in, true), true;
    case Op::ixor:
    case Op::bxor:
      return binary(op::xor_ps, in, true), true;
    case Op::ishl:
      return binary(op::shift_left, in), true;
    case Op::ishr:
      return binary(op::shift_right, in), true;
    case Op::isar:
      return binary(op::shift_signed, in), true;
    case Op::ieq:
      return binary(op::equal_d, in, true), true;
    case Op::ine:
      return binary(op::equal_d, in, true), invert(in), true;
    case Op::ilt:
      return swapped(op::greater_d, in), true;
    case Op::ile:
      return binary(op::greater_d, in), invert(in), true;
    case Op::bnot:
      return with_constant(op::xor_ps, in, all_ones), true;
    case Op::select:
      return select(in), true;
    case Op::f2i:
      return unary(op::truncate_to_int, in), true;
    case Op::i2f:
      return unary(op::to_float, in), true;
    case Op::f2bits:
    case Op::bits2f:
      return places_.define(in.result(), places_.copy(in.operands[0])), true;
    case Op::table_f32: {
      std::vector<std::uint32_t> bits;
      for (const float entry : module.float_tables[index].entries)
        bits.push_back(std::bit_cast<std::uint32_t>(entry));
      return table(bits, in), true;
    }
    case Op::table_i32: {
      const auto& entries = module.int_tables[index].entries;
      return table(std::vector<std::uint32_t>(entries.begin(), entries.end()), in), true;
    }
    case Op::bytes_add:
      return binary(op::add_b, in, true), true;
    case Op::bytes_lookup:
      return byte_lookup(in), true;
    default:
      return false;
  }
}

void FunctionCode::input(const ir::Instruction& in) {
  if (kernel_.split.module.inputs[static_cast<std::size_t>(in.imm)].rate != ir::Rate::sample)
    return places_.set_uniform(in.result(), in.imm);
  code_.load(Gpr::rax, {call_base, offsetof(KernelCall, inputs)});
  code_.load(Gpr::rax, {Gpr::rax, 8 * in.imm});
  code_.load(places_.define(in.result()), {Gpr::rax, 0, static_cast<int>(sample_index)});
}

void FunctionCode::binary(const VectorOp& op, const ir::Instruction& in, bool commutes, int byte) {
  ir::Value a = in.operands[0], b = in.operands[1];
  // Only the last operand may stand in memory.
  if (commutes && !places_.has_register(a) && (places_.is_constant(a) || places_.has_register(b)))
    std::swap(a, b);
  const Ymm first = places_.in_register(a);
  const Operand last = places_.operand(b);
  places_.release_operands();
  const Ymm to = places_.define(in.result());
  if (byte < 0) {
    code_.vector(op, to, first, last);
  } else {
    code_.vector(op, to, first, last, byte);
  }
}

void FunctionCode::swapped(const VectorOp& op, const ir::Instruction& in) {
  const Ymm first = places_.in_register(in.operands[1]);
  const Operand last = places_.operand(in.operands[0]);
  places_.release_operands();
  code_.vector(op, places_.define(in.result()), first, last);
}

void FunctionCode::unary(const VectorOp& op, const ir::Instruction& in, int byte) {
  const Operand from = places_.operand(in.operands[0]);
  places_.release_operands();
  const Ymm to = places_.define(in.result());
  if (byte < 0) {
    code_.vector(op, to, 0, from);
  } else {
    code_.vector(op, to, 0, from, byte);
  }
}

void FunctionCode::with_constant(const VectorOp& op, const ir::Instruction& in,
                                 std::uint32_t bits) {
  const Ymm from = places_.in_register(in.operands[0]);
  places_.release_operands();
  code_.vector(op, places_.define(in.result()), from, all(bits));
}

// The result's opposite.
void FunctionCode::invert(const ir::Instruction& in) {
  const Ymm reg = places_.in_register(in.result());
  code_.vector(op::xor_ps, reg, reg, all(all_ones));
}

// a * b + c over a register that is not needed afterwards: that of a factor, or of c.
void FunctionCode::fused(const ir::Instruction& in) {
  ir::Value a = in.operands[0], b = in.operands[1];
  const ir::Value c = in.operands[2];
  if (places_.has_register(c) && places_.dies(c) && c != a && c != b) {
    const Ymm first = places_.in_register(a);
    const Operand last = places_.operand(b);
    const Ymm sum = places_.copy(c);
    code_.vector(op::fma231, sum, first, last);
    return places_.define(in.result(), sum);
  }
  if (places_.has_register(b) && places_.dies(b)) std::swap(a, b);
  const Ymm second = places_.in_register(b);
  const Operand last = places_.operand(c);
  const Ymm product = places_.copy(a);
  code_.vector(op::fma213, product, second, last);
  places_.define(in.result(), product);
}

void FunctionCode::select(const ir::Instruction& in) {
  const Ymm condition = places_.in_register(in.operands[0]);
  const Ymm no = places_.in_register(in.operands[2]);
  const Operand yes = places_.operand(in.operands[1]);
  places_.release_operands();
  code_.blend(places_.define(in.result()), no, yes, condition);
}

// Up to 16 entries fit into registers; the permutation takes an index mod 8 by itself.
void FunctionCode::table(std::span<const std::uint32_t> entries, const ir::Instruction& in) {
  const std::size_t size = entries.size();
  if (size == 1) return places_.set_constant(in.result(), all(entries[0]));
  const auto key = static_cast<std::int64_t>(in.op) << 32 | in.imm;
  const auto [known, fresh] = kernel_.tables.try_emplace(key);
  if (fresh) {
    std::vector<std::uint32_t> words(entries.begin(), entries.end());
    while (words.size() < 8) words.insert(words.end(), entries.begin(), entries.end());
    known->second = kernel_.constants.list(std::span<const std::uint32_t>(words));
  }
  Memory from = known->second;
  const Ymm index = places_.in_register(in.operands[0]);
  const Ymm to = places_.define(in.result());
  if (size <= 8) return code_.vector(op::permute_ps, to, index, from);
  const Ymm other = places_.temporary();
  if (size == 16) {
    const Ymm upper = places_.temporary();
    code_.vector(op::permute_ps, to, index, from);
    code_.vector(op::permute_ps, upper, index, Memory{from.base, from.disp + row_size});
    code_.shift_left_by(other, index, 28);
    return code_.blend(to, to, upper, other);
  }
  const Ymm mask = places_.temporary();
  code_.vector(op::and_ps, other, index, all(static_cast<std::uint32_t>(size - 1)));
  ones(mask);
  from.index = other;
  code_.gather(to, from, mask);
}

// The lookup is a piece of code of its own, which takes and gives register 0 and uses three more.
void FunctionCode::byte_lookup(const ir::Instruction& in) {
  const Operand from = places_.operand(in.operands[0]);
  places_.release_operands();
  for (Ymm reg = 0; reg < 4; ++reg) places_.take_register(reg);
  if (from.in_memory) {
    code_.load(0, from.memory);
  } else if (from.reg != 0) {
    code_.move(0, from.reg);
  }
  code_.call(kernel_.byte_lookups[in.imm]);
  places_.define(in.result(), 0);
}

}  // namespace pse::first
