// What the scalar operators compute, from bits to bits: the sentences of ops.cpp as code.
// The interpreter runs it and the constant folder asks it, so that both mean the same.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "ir/module.h"

namespace pse::ir {

// A value of any type as 32 bits: the float's bits, the integer's, or 0 and 1.
using Bits = std::uint32_t;

inline constexpr Bits nan_bits = 0x7fc00000u;

inline bool is_nan_bits(Bits bits) { return (bits & 0x7fffffffu) > 0x7f800000u; }
// Every NaN is the same value: the one that outputs store.
inline Bits canonical(Bits bits) { return is_nan_bits(bits) ? nan_bits : bits; }
inline float to_f32(Bits bits) { return std::bit_cast<float>(bits); }
inline Bits to_bits(float value) { return std::bit_cast<Bits>(value); }

// The operators that need no more than the bits of their operands.
inline bool is_scalar(Op op) { return op >= Op::fadd && op <= Op::bits2f; }

inline Bits evaluate_f2i(float a) {
  const bool fits = a >= -2147483648.0f && a < 2147483648.0f;
  return fits ? static_cast<Bits>(static_cast<std::int32_t>(a)) : 0x80000000u;
}

inline Bits evaluate_bytes_add(Bits a, Bits b) {
  // The low seven bits of each byte add without carrying over; the top bits add by exclusive or.
  return ((a & 0x7f7f7f7fu) + (b & 0x7f7f7f7fu)) ^ ((a ^ b) & 0x80808080u);
}

// The result of a scalar operator; operands that it does not have are ignored.
inline Bits evaluate(Op op, Bits a, Bits b, Bits c) {
  const auto fa = to_f32(a), fb = to_f32(b), fc = to_f32(c);
  const auto ia = static_cast<std::int32_t>(a), ib = static_cast<std::int32_t>(b);
  switch (op) {
    case Op::fadd:
      return to_bits(fa + fb);
    case Op::fsub:
      return to_bits(fa - fb);
    case Op::fmul:
      return to_bits(fa * fb);
    case Op::fdiv:
      return to_bits(fa / fb);
    case Op::fma:
      return to_bits(std::fma(fa, fb, fc));
    case Op::fneg:
      return a ^ 0x80000000u;
    case Op::fabs:
      return a & 0x7fffffffu;
    case Op::fsqrt:
      return to_bits(std::sqrt(fa));
    case Op::fmin:
      return fa < fb ? a : b;
    case Op::fmax:
      return fa > fb ? a : b;
    case Op::ffloor:
      return to_bits(std::floor(fa));
    case Op::fceil:
      return to_bits(std::ceil(fa));
    case Op::ftrunc:
      return to_bits(std::trunc(fa));
    case Op::fround:
      return to_bits(std::nearbyint(fa));
    case Op::feq:
      return fa == fb;
    case Op::fne:
      return fa != fb;
    case Op::flt:
      return fa < fb;
    case Op::fle:
      return fa <= fb;
    case Op::iadd:
      return a + b;
    case Op::isub:
      return a - b;
    case Op::imul:
      return a * b;
    case Op::iand:
      return a & b;
    case Op::ior:
      return a | b;
    case Op::ixor:
      return a ^ b;
    case Op::ishl:
      return b > 31 ? 0 : a << b;
    case Op::ishr:
      return b > 31 ? 0 : a >> b;
    case Op::isar:
      return static_cast<Bits>(ia >> (b > 31 ? 31 : b));
    case Op::ieq:
      return a == b;
    case Op::ine:
      return a != b;
    case Op::ilt:
      return ia < ib;
    case Op::ile:
      return ia <= ib;
    case Op::band:
      return a & b;
    case Op::bor:
      return a | b;
    case Op::bxor:
      return a ^ b;
    case Op::bnot:
      return a ^ 1u;
    case Op::select:
      return a ? b : c;
    case Op::f2i:
      return evaluate_f2i(fa);
    case Op::i2f:
      return to_bits(static_cast<float>(ia));
    case Op::f2bits:
      return a;
    case Op::bits2f:
      return a;
    default:
      return 0;
  }
}

// The result of table_f32, table_i32, bytes_add or bytes_lookup.
inline Bits evaluate_table(const Module& module, Op op, std::int32_t table, Bits a, Bits b) {
  const auto index = static_cast<std::size_t>(table);
  if (op == Op::bytes_add) return evaluate_bytes_add(a, b);
  if (op == Op::table_f32) {
    const auto& entries = module.float_tables[index].entries;
    return to_bits(entries[a & (entries.size() - 1)]);
  }
  if (op == Op::table_i32) {
    const auto& entries = module.int_tables[index].entries;
    return static_cast<Bits>(entries[a & (entries.size() - 1)]);
  }
  const auto& entries = module.byte_tables[index].entries;
  Bits found = 0;
  for (unsigned shift = 0; shift < 32; shift += 8)
    found |= Bits{entries[(a >> shift) & 255]} << shift;
  return found;
}

}  // namespace pse::ir
