// The operator table of the IR: every operator, what it takes and gives, and its meaning in one
// sentence. The interpreter (ir/interpreter), the constant folder and the LLVM emitter must all
// agree with this table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace pse::ir {

enum class Type : std::uint8_t { f32, i32, boolean };

enum class Op : std::uint8_t {
  // constants and the sample's environment
  const_f32, const_i32, const_bool, input, slope,
  // float arithmetic
  fadd, fsub, fmul, fdiv, fma, fneg, fabs, fsqrt, fmin, fmax, ffloor, fceil, ftrunc, fround,
  // float comparison
  feq, fne, flt, fle,
  // integer arithmetic
  iadd, isub, imul, iand, ior, ixor, ishl, ishr, isar,
  // integer comparison
  ieq, ine, ilt, ile,
  // booleans
  band, bor, bxor, bnot,
  // choice and conversion
  select, f2i, i2f, f2bits, bits2f,
  // small constant tables
  table_f32, table_i32, bytes_add, bytes_lookup,
  // arrays (memory of the sample or of the frame)
  array_load, array_store, array_length, array_resize,
  // effects and calls
  check, call, external,
  // structured control
  if_, loop
};

struct OpInfo {
  Op op;
  std::string_view name;      // as in the text form
  // One letter each: f i b; T: any one type, the same for every T; *: see meaning.
  std::string_view operands;
  std::string_view results;   // likewise
  // No effect besides its results; may be moved, repeated or dropped. An external without results
  // has one: passes/rewrite.h, is_effect().
  bool pure;
  std::string_view meaning;
};

// The table, in the order of the enum.
std::span<const OpInfo> op_table();
const OpInfo& info(Op op);

}  // namespace pse::ir
