// The encodings. See the header.
#include "codegen/first/assembler.h"

#include <cstring>

namespace pse::first {
namespace {

int number(Gpr reg) { return static_cast<int>(reg); }
bool is_small(std::int32_t value) { return value >= -128 && value <= 127; }

}  // namespace

void Assembler::word(std::int32_t value) {
  for (int shift = 0; shift < 32; shift += 8) byte(value >> shift & 255);
}

// ModRM, and where needed SIB and displacement. Register 4 as base asks for a SIB byte, register 5
// without displacement would mean something else.
void Assembler::modrm(int reg, const Memory& m) {
  const int base = number(m.base) & 7;
  const bool sib = m.index >= 0 || base == 4;
  const int mode = m.disp == 0 && base != 5 ? 0 : is_small(m.disp) ? 1 : 2;
  byte(mode << 6 | (reg & 7) << 3 | (sib ? 4 : base));
  if (sib) byte(m.index >= 0 ? 2 << 6 | (m.index & 7) << 3 | base : 4 << 3 | base);
  if (mode == 1) byte(m.disp & 255);
  if (mode == 2) word(m.disp);
}

// ---- Vectors ----

// The prefix of two bytes where it says all, else of three; L is set: 256 bits.
void Assembler::vex(const VectorOp& op, int reg, Ymm first, const Operand& last) {
  const int base = last.in_memory ? number(last.memory.base) : last.reg;
  const int index = last.in_memory && last.memory.index >= 0 ? last.memory.index : 0;
  const int r = reg < 8, x = index < 8, b = base < 8;
  const int end = (~first & 15) << 3 | 1 << 2 | op.prefix;
  if (x && b && op.map == 1 && op.w == 0) {
    byte(0xc5);
    byte(r << 7 | end);
  } else {
    byte(0xc4);
    byte(r << 7 | x << 6 | b << 5 | op.map);
    byte(op.w << 7 | end);
  }
  byte(op.opcode);
  if (last.in_memory) return modrm(reg, last.memory);
  byte(3 << 6 | (reg & 7) << 3 | (last.reg & 7));
}

void Assembler::vector(const VectorOp& op, Ymm to, Ymm first, const Operand& last) {
  vex(op, to, first, last);
}

void Assembler::vector(const VectorOp& op, Ymm to, Ymm first, const Operand& last, int immediate) {
  vex(op, to, first, last);
  byte(immediate);
}

void Assembler::blend(Ymm to, Ymm no, const Operand& yes, Ymm mask) {
  vector(op::blend_ps, to, no, yes, mask << 4);
}

void Assembler::shift_left_by(Ymm to, Ymm from, int bits) {
  // 66 0f 72 /6: the target stands where other instructions have their first operand.
  vector({1, 1, 0x72}, 6, to, from, bits);
}

void Assembler::zero_upper() {
  byte(0xc5);
  byte(0xf8);
  byte(0x77);
}

// ---- General registers ----

void Assembler::rex(bool wide, int reg, int rm, int index) {
  const int bits = (wide ? 8 : 0) | (reg >= 8 ? 4 : 0) | (index >= 8 ? 2 : 0) | (rm >= 8 ? 1 : 0);
  if (bits != 0) byte(0x40 | bits);
}

void Assembler::general(bool wide, int opcode, int reg, const Memory& m) {
  rex(wide, reg, number(m.base), m.index >= 0 ? m.index : 0);
  byte(opcode);
  modrm(reg, m);
}

void Assembler::load(Gpr to, const Memory& from) { general(true, 0x8b, number(to), from); }
void Assembler::load32(Gpr to, const Memory& from) { general(false, 0x8b, number(to), from); }
void Assembler::compare32(Gpr a, const Memory& b) { general(false, 0x3b, number(a), b); }
void Assembler::store(const Memory& to, Gpr from) { general(true, 0x89, number(from), to); }
void Assembler::address(Gpr to, const Memory& of) { general(true, 0x8d, number(to), of); }
void Assembler::compare(Gpr a, const Memory& b) { general(true, 0x3b, number(a), b); }

void Assembler::store32(const Memory& to, std::int32_t value) {
  rex(false, 0, number(to.base));
  byte(0xc7);
  modrm(0, to);
  word(value);
}

std::size_t Assembler::address_ahead(Gpr to) {
  rex(true, number(to), 0);
  byte(0x8d);
  byte((number(to) & 7) << 3 | 5);
  word(0);
  return size() - 4;
}

void Assembler::fill_distance(std::size_t where, std::size_t to) {
  const auto distance = static_cast<std::int32_t>(static_cast<std::int64_t>(to) -
                                                  static_cast<std::int64_t>(where) - 4);
  std::memcpy(code_.data() + where, &distance, sizeof distance);
}

void Assembler::pair(int opcode, Gpr to, Gpr from) {
  rex(true, number(from), number(to));
  byte(opcode);
  byte(3 << 6 | (number(from) & 7) << 3 | (number(to) & 7));
}

void Assembler::move(Gpr to, Gpr from) { pair(0x89, to, from); }

void Assembler::set32(Gpr to, std::int32_t value) {
  rex(false, 0, number(to));
  byte(0xb8 | (number(to) & 7));
  word(value);
}

void Assembler::set64(Gpr to, std::uint64_t value) {
  rex(true, 0, number(to));
  byte(0xb8 | (number(to) & 7));
  word(static_cast<std::int32_t>(value));
  word(static_cast<std::int32_t>(value >> 32));
}

void Assembler::add(Gpr to, Gpr other) { pair(0x01, to, other); }

void Assembler::add(Gpr to, std::int32_t value) {
  rex(true, 0, number(to));
  byte(0x81);
  byte(3 << 6 | (number(to) & 7));
  word(value);
}

void Assembler::compare_byte(const Memory& a, std::int8_t with) {
  rex(false, 0, number(a.base));
  byte(0x80);
  modrm(7, a);
  byte(with & 255);
}

void Assembler::test32(Gpr a) {
  rex(false, number(a), number(a));
  byte(0x85);
  byte(3 << 6 | (number(a) & 7) << 3 | (number(a) & 7));
}

void Assembler::lowest_bit(Gpr to, Gpr from) {
  rex(false, number(to), number(from));
  byte(0x0f);
  byte(0xbc);
  byte(3 << 6 | (number(to) & 7) << 3 | (number(from) & 7));
}

void Assembler::fill_dwords() {
  byte(0xf3);
  byte(0xab);
}

void Assembler::push(Gpr reg) {
  rex(false, 0, number(reg));
  byte(0x50 | (number(reg) & 7));
}

void Assembler::pop(Gpr reg) {
  rex(false, 0, number(reg));
  byte(0x58 | (number(reg) & 7));
}

// ---- Jumps ----

void Assembler::distance_to(Label& to) {
  word(0);
  if (to.place < 0) return to.waiting.push_back(size() - 4);
  fill_distance(size() - 4, static_cast<std::size_t>(to.place));
}

void Assembler::jump(Label& to) {
  byte(0xe9);
  distance_to(to);
}

void Assembler::jump(When when, Label& to) {
  byte(0x0f);
  byte(0x80 | static_cast<int>(when));
  distance_to(to);
}

void Assembler::call(Label& to) {
  byte(0xe8);
  distance_to(to);
}

void Assembler::call(Gpr target) {
  rex(false, 0, number(target));
  byte(0xff);
  byte(3 << 6 | 2 << 3 | (number(target) & 7));
}

void Assembler::bind(Label& label) {
  label.place = static_cast<std::int64_t>(size());
  for (const std::size_t where : label.waiting) fill_distance(where, size());
  label.waiting.clear();
}

}  // namespace pse::first
