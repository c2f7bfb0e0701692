// An encoder for the few x86-64 instructions that the first tier writes: AVX2 and FMA on whole
// vectors of eight lanes, and what jumps and calls need. Encodings as in Intel's manual, volume 2,
// section 2.3 (the VEX prefix). The last step of codegen/first: function_code.cpp calls it.
#pragma once

#include <cstdint>
#include <vector>

namespace pse::first {

// General registers by their number in the encoding.
enum class Gpr : std::uint8_t {
  rax,
  rcx,
  rdx,
  rbx,
  rsp,
  rbp,
  rsi,
  rdi,
  r8,
  r9,
  r10,
  r11,
  r12,
  r13,
  r14,
  r15
};

// A vector register 0..15, by number.
using Ymm = int;

// Memory at base + disp, or at base + index * 4 + disp.
struct Memory {
  Gpr base = Gpr::rbx;
  std::int32_t disp = 0;
  int index = -1;  // a general register, or a vector of them (gather)
};

// The last operand of a vector instruction: a register or memory.
struct Operand {
  bool in_memory = false;
  Ymm reg = 0;
  Memory memory;

  Operand(Ymm r) : reg(r) {}
  Operand(const Memory& m) : in_memory(true), memory(m) {}
};

// An instruction by its prefix byte (pp), opcode map and opcode; `w`: the prefix's W bit.
struct VectorOp {
  std::uint8_t prefix, map, opcode;
  std::uint8_t w = 0;
};

// pp: 0 none, 1 0x66, 2 0xf3. map: 1 0f, 2 0f38, 3 0f3a.
namespace op {
inline constexpr VectorOp add_ps{0, 1, 0x58}, mul_ps{0, 1, 0x59}, sub_ps{0, 1, 0x5c},
    min_ps{0, 1, 0x5d}, div_ps{0, 1, 0x5e}, max_ps{0, 1, 0x5f}, sqrt_ps{0, 1, 0x51},
    and_ps{0, 1, 0x54}, andnot_ps{0, 1, 0x55}, or_ps{0, 1, 0x56}, xor_ps{0, 1, 0x57},
    compare_ps{0, 1, 0xc2}, load{0, 1, 0x10}, store{0, 1, 0x11}, move{0, 1, 0x28},
    to_float{0, 1, 0x5b}, truncate_to_int{2, 1, 0x5b}, mask_bits{0, 1, 0x50}, round_ps{1, 3, 0x08},
    blend_ps{1, 3, 0x4a}, fma213{1, 2, 0xa8}, fma231{1, 2, 0xb8}, add_d{1, 1, 0xfe},
    sub_d{1, 1, 0xfa}, mul_d{1, 2, 0x40}, shift_left{1, 2, 0x47}, shift_right{1, 2, 0x45},
    shift_signed{1, 2, 0x46}, equal_d{1, 1, 0x76}, greater_d{1, 1, 0x66}, add_b{1, 1, 0xfc},
    sub_saturated_b{1, 1, 0xe8}, shuffle_b{1, 2, 0x00}, permute_ps{1, 2, 0x16},
    broadcast{1, 2, 0x18}, broadcast_half{1, 2, 0x5a}, gather_ps{1, 2, 0x92};
}  // namespace op

// A place in the code that jumps go to, bound before or after them.
struct Label {
  std::int64_t place = -1;
  std::vector<std::size_t> waiting;  // distances to be filled in
};

class Assembler {
 public:
  const std::vector<std::uint8_t>& code() const { return code_; }
  std::size_t size() const { return code_.size(); }

  // op to, first, last; instructions without `first` take none (pass 0).
  void vector(const VectorOp& op, Ymm to, Ymm first, const Operand& last);
  // The same followed by one byte: a comparison's kind, a rounding mode.
  void vector(const VectorOp& op, Ymm to, Ymm first, const Operand& last, int byte);
  // to = mask's top bits ? yes : no
  void blend(Ymm to, Ymm no, const Operand& yes, Ymm mask);
  void load(Ymm to, const Memory& from) { vector(op::load, to, 0, from); }
  void store(const Memory& to, Ymm from) { vector(op::store, from, 0, to); }
  void move(Ymm to, Ymm from) { vector(op::move, to, 0, from); }
  // All lanes shifted left by a constant.
  void shift_left_by(Ymm to, Ymm from, int bits);
  // The lanes of memory[index[lane]] whose mask has its top bit; clears `mask`.
  void gather(Ymm to, const Memory& from, Ymm mask) { vector(op::gather_ps, to, mask, from); }
  // One bit per lane.
  void mask_bits(Gpr to, Ymm from) { vector(op::mask_bits, static_cast<int>(to), 0, from); }
  void zero_upper();

  void load(Gpr to, const Memory& from);  // 64 bits
  void load32(Gpr to, const Memory& from);
  void store(const Memory& to, Gpr from);  // 64 bits
  void store32(const Memory& to, std::int32_t value);
  void address(Gpr to, const Memory& of);
  // The address of a place `distance` bytes behind the end of this instruction; returns where to
  // fill the distance in.
  std::size_t address_ahead(Gpr to);
  void move(Gpr to, Gpr from);
  void set32(Gpr to, std::int32_t value);  // zero-extended
  void set64(Gpr to, std::uint64_t value);
  void add(Gpr to, Gpr other);
  void add(Gpr to, std::int32_t value);
  void compare(Gpr a, const Memory& b);
  void compare32(Gpr a, const Memory& b);
  void compare_byte(const Memory& a, std::int8_t with);
  void test32(Gpr a);
  void lowest_bit(Gpr to, Gpr from);  // its number; `from` is not 0
  void fill_dwords();                 // rep stosd: rcx times eax at rdi
  void push(Gpr reg);
  void pop(Gpr reg);
  void ret() { byte(0xc3); }

  enum class When : std::uint8_t { not_below = 3, equal = 4, not_equal = 5, not_less = 13 };
  void jump(Label& to);
  void jump(When when, Label& to);
  void call(Label& to);
  void call(Gpr address);
  void bind(Label& label);
  void fill_distance(std::size_t where, std::size_t to);

 private:
  void byte(int value) { code_.push_back(static_cast<std::uint8_t>(value)); }
  void word(std::int32_t value);
  void vex(const VectorOp& op, int reg, Ymm first, const Operand& last);
  void rex(bool wide, int reg, int rm, int index = 0);
  void pair(int opcode, Gpr to, Gpr from);  // an instruction of two registers of 64 bits
  void general(bool wide, int opcode, int reg, const Memory& memory);
  void modrm(int reg, const Memory& memory);
  void distance_to(Label& to);

  std::vector<std::uint8_t> code_;
};

}  // namespace pse::first
