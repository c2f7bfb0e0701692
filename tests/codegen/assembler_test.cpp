// The first tier's encoder against the bytes that GNU as gives for the same instructions: each
// prefix, registers above 7, bases that need a SIB byte or a displacement, both sizes of that.
#include "codegen/first/assembler.h"

#include <gtest/gtest.h>

#include <functional>

namespace pse::first {
namespace {

using enum Gpr;
using Bytes = std::vector<std::uint8_t>;

Bytes written(const std::function<void(Assembler&)>& write) {
  Assembler code;
  write(code);
  return code.code();
}

struct Case {
  const char* text;
  std::function<void(Assembler&)> write;
  Bytes bytes;
};

TEST(Assembler, WritesTheBytesOfTheManual) {
  const std::vector<Case> cases = {
      {"vaddps ymm1, ymm2, ymm3",
       [](auto& c) { c.vector(op::add_ps, 1, 2, 3); },
       {0xc5, 0xec, 0x58, 0xcb}},
      {"vaddps ymm9, ymm10, ymm11",
       [](auto& c) { c.vector(op::add_ps, 9, 10, 11); },
       {0xc4, 0x41, 0x2c, 0x58, 0xcb}},
      {"vsubps ymm1, ymm2, [rbx+0x20]",
       [](auto& c) {
         c.vector(op::sub_ps, 1, 2, Memory{rbx, 0x20});
       },
       {0xc5, 0xec, 0x5c, 0x4b, 0x20}},
      {"vsubps ymm1, ymm2, [rbx+0x1000]",
       [](auto& c) {
         c.vector(op::sub_ps, 1, 2, Memory{rbx, 0x1000});
       },
       {0xc5, 0xec, 0x5c, 0x8b, 0x00, 0x10, 0x00, 0x00}},
      {"vmulps ymm8, ymm0, [rbp]",
       [](auto& c) { c.vector(op::mul_ps, 8, 0, Memory{rbp}); },
       {0xc5, 0x7c, 0x59, 0x45, 0x00}},
      {"vdivps ymm0, ymm15, [r13]",
       [](auto& c) { c.vector(op::div_ps, 0, 15, Memory{r13}); },
       {0xc4, 0xc1, 0x04, 0x5e, 0x45, 0x00}},
      {"vminps ymm3, ymm4, [r12+8]",
       [](auto& c) {
         c.vector(op::min_ps, 3, 4, Memory{r12, 8});
       },
       {0xc4, 0xc1, 0x5c, 0x5d, 0x5c, 0x24, 0x08}},
      {"vcmpltps (quiet) ymm1, ymm2, ymm3",
       [](auto& c) { c.vector(op::compare_ps, 1, 2, 3, 0x11); },
       {0xc5, 0xec, 0xc2, 0xcb, 0x11}},
      {"vroundps ymm12, ymm1, 9",
       [](auto& c) { c.vector(op::round_ps, 12, 0, 1, 9); },
       {0xc4, 0x63, 0x7d, 0x08, 0xe1, 0x09}},
      {"vblendvps ymm1, ymm2, ymm3, ymm14",
       [](auto& c) { c.blend(1, 2, 3, 14); },
       {0xc4, 0xe3, 0x6d, 0x4a, 0xcb, 0xe0}},
      {"vfmadd213ps ymm1, ymm2, ymm13",
       [](auto& c) { c.vector(op::fma213, 1, 2, 13); },
       {0xc4, 0xc2, 0x6d, 0xa8, 0xcd}},
      {"vfmadd231ps ymm9, ymm2, [rbx-32]",
       [](auto& c) {
         c.vector(op::fma231, 9, 2, Memory{rbx, -32});
       },
       {0xc4, 0x62, 0x6d, 0xb8, 0x4b, 0xe0}},
      {"vpsllvd ymm1, ymm2, ymm3",
       [](auto& c) { c.vector(op::shift_left, 1, 2, 3); },
       {0xc4, 0xe2, 0x6d, 0x47, 0xcb}},
      {"vpslld ymm10, ymm3, 28",
       [](auto& c) { c.shift_left_by(10, 3, 28); },
       {0xc5, 0xad, 0x72, 0xf3, 0x1c}},
      {"vpmulld ymm1, ymm2, ymm9",
       [](auto& c) { c.vector(op::mul_d, 1, 2, 9); },
       {0xc4, 0xc2, 0x6d, 0x40, 0xc9}},
      {"vpermps ymm1, ymm2, [rbp+64]",
       [](auto& c) {
         c.vector(op::permute_ps, 1, 2, Memory{rbp, 64});
       },
       {0xc4, 0xe2, 0x6d, 0x16, 0x4d, 0x40}},
      {"vbroadcastss ymm7, [r13+12]",
       [](auto& c) {
         c.vector(op::broadcast, 7, 0, Memory{r13, 12});
       },
       {0xc4, 0xc2, 0x7d, 0x18, 0x7d, 0x0c}},
      {"vgatherdps ymm1, [rax+ymm2*4+16], ymm3",
       [](auto& c) {
         c.gather(1, {rax, 16, 2}, 3);
       },
       {0xc4, 0xe2, 0x65, 0x92, 0x4c, 0x90, 0x10}},
      {"vgatherdps ymm9, [rbp+ymm12*4], ymm3",
       [](auto& c) {
         c.gather(9, {rbp, 0, 12}, 3);
       },
       {0xc4, 0x22, 0x65, 0x92, 0x4c, 0xa5, 0x00}},
      {"vmovmskps eax, ymm9", [](auto& c) { c.mask_bits(rax, 9); }, {0xc4, 0xc1, 0x7c, 0x50, 0xc1}},
      {"vcvttps2dq ymm1, ymm2",
       [](auto& c) { c.vector(op::truncate_to_int, 1, 0, 2); },
       {0xc5, 0xfe, 0x5b, 0xca}},
      {"vmovups ymm2, [rax+r14*4]",
       [](auto& c) {
         c.load(2, {rax, 0, 14});
       },
       {0xc4, 0xa1, 0x7c, 0x10, 0x14, 0xb0}},
      {"vmovups [rax+r14*4], ymm2",
       [](auto& c) {
         c.store({rax, 0, 14}, 2);
       },
       {0xc4, 0xa1, 0x7c, 0x11, 0x14, 0xb0}},
      {"vzeroupper", [](auto& c) { c.zero_upper(); }, {0xc5, 0xf8, 0x77}},
      {"mov rax, [r12+16]",
       [](auto& c) {
         c.load(rax, {r12, 16});
       },
       {0x49, 0x8b, 0x44, 0x24, 0x10}},
      {"mov [r12+16], rax",
       [](auto& c) {
         c.store({r12, 16}, rax);
       },
       {0x49, 0x89, 0x44, 0x24, 0x10}},
      {"mov dword [r12+72], 3",
       [](auto& c) {
         c.store32({r12, 72}, 3);
       },
       {0x41, 0xc7, 0x44, 0x24, 0x48, 0x03, 0x00, 0x00, 0x00}},
      {"mov r10d, [rbx+rax*4+32]",
       [](auto& c) {
         c.load32(r10, {rbx, 32, 0});
       },
       {0x44, 0x8b, 0x54, 0x83, 0x20}},
      {"cmp r10d, [rax+8]",
       [](auto& c) {
         c.compare32(r10, {rax, 8});
       },
       {0x44, 0x3b, 0x50, 0x08}},
      {"vbroadcastss ymm1, [rax+r10*4+64]",
       [](auto& c) {
         c.vector(op::broadcast, 1, 0, Memory{rax, 64, 10});
       },
       {0xc4, 0xa2, 0x7d, 0x18, 0x4c, 0x90, 0x40}},
      {"lea rsi, [rbx+64]",
       [](auto& c) {
         c.address(rsi, {rbx, 64});
       },
       {0x48, 0x8d, 0x73, 0x40}},
      {"mov rdi, r12", [](auto& c) { c.move(rdi, r12); }, {0x4c, 0x89, 0xe7}},
      {"mov r8d, 7", [](auto& c) { c.set32(r8, 7); }, {0x41, 0xb8, 0x07, 0x00, 0x00, 0x00}},
      {"movabs rax, 0x1122334455667788",
       [](auto& c) { c.set64(rax, 0x1122334455667788u); },
       {0x48, 0xb8, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11}},
      {"add rax, r14", [](auto& c) { c.add(rax, r14); }, {0x4c, 0x01, 0xf0}},
      {"cmp r14, [r12+16]",
       [](auto& c) {
         c.compare(r14, {r12, 16});
       },
       {0x4d, 0x3b, 0x74, 0x24, 0x10}},
      {"cmp byte [r15], 0", [](auto& c) { c.compare_byte({r15}, 0); }, {0x41, 0x80, 0x3f, 0x00}},
      {"test eax, eax", [](auto& c) { c.test32(rax); }, {0x85, 0xc0}},
      {"bsf eax, eax", [](auto& c) { c.lowest_bit(rax, rax); }, {0x0f, 0xbc, 0xc0}},
      {"rep stosd", [](auto& c) { c.fill_dwords(); }, {0xf3, 0xab}},
      {"push r12", [](auto& c) { c.push(r12); }, {0x41, 0x54}},
      {"pop rbx", [](auto& c) { c.pop(rbx); }, {0x5b}},
      {"call rax", [](auto& c) { c.call(rax); }, {0xff, 0xd0}},
  };
  for (const Case& c : cases) EXPECT_EQ(written(c.write), c.bytes) << c.text;
}

// Distances count from the end of the instruction, forwards and backwards.
TEST(Assembler, JumpsReachTheirLabels) {
  const Bytes code = written([](Assembler& c) {
    Label ahead, back;
    c.bind(back);
    c.jump(Assembler::When::equal, ahead);  // 6 bytes: 0f 84 and the distance
    c.jump(back);                           // 5 bytes, the end is at 11
    c.call(ahead);                          // 5 bytes
    c.bind(ahead);                          // at 16
    c.ret();
  });
  EXPECT_EQ(code,
            (Bytes{0x0f, 0x84, 10, 0, 0, 0, 0xe9, 0xf5, 0xff, 0xff, 0xff, 0xe8, 0, 0, 0, 0, 0xc3}));
}

}  // namespace
}  // namespace pse::first
