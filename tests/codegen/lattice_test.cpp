// The steps of a lattice noise that share work: hashes of which only half a byte is asked for,
// gradients looked up by the bytes of one word, and their products with places in a cell.
#include <cmath>

#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

class Lattice : public OnEveryMachine {};

std::uint8_t permuted(std::uint32_t byte) {
  return static_cast<std::uint8_t>((byte & 255u) * 167 + 13);
}

// Zeros and ones of both signs, as gradients are, and with `odd` other numbers, which no byte
// holds.
float entry(std::uint32_t i, bool odd) {
  static constexpr float ones[] = {1, -1, 0, 1, 0, 0, -1};
  return odd ? static_cast<float>(i) * 0.3f - 2 : ones[i % 7];
}

std::int32_t add_table(ir::Module& module, std::uint32_t size, bool odd) {
  module.float_tables.push_back({"t" + std::to_string(module.float_tables.size()), {}});
  for (std::uint32_t i = 0; i < size; ++i)
    module.float_tables.back().entries.push_back(entry(i, odd));
  return static_cast<std::int32_t>(module.float_tables.size() - 1);
}

// Tables of 8 to 32 entries indexed by each byte of a looked-up word. One word in two is also an
// output itself, so that all of it must be right.
TEST_P(Lattice, TablesIndexedByHashes) {
  for (const bool whole_word : {false, true}) {
    TestProgram program;
    ir::Module& module = program.split.module;
    module.byte_tables.push_back({"b", {}});
    for (std::uint32_t i = 0; i < 256; ++i) module.byte_tables[0].entries.push_back(permuted(i));
    ir::Builder& b = program.build;
    const ir::Value word = b.emit(Op::bytes_lookup, {program.input_int(ir::Rate::sample)});
    for (const std::uint32_t size : {8u, 16u, 32u}) {
      for (const bool odd : {false, true}) {
        const std::int32_t table = add_table(module, size, odd);
        for (int k = 0; k < 4; ++k) {
          const ir::Value index = k == 0 ? word : b.emit(Op::ishr, {word, b.const_i32(8 * k)});
          program.output(b.emit(Op::table_f32, {index}, table));
        }
      }
    }
    if (whole_word) program.output_int(word);
    program.finish();
    const auto kernel = compile(program, GetParam());
    ASSERT_TRUE(kernel);
    Columns columns(2);
    for (std::uint32_t i = 0; i < 256; ++i) {
      columns[0].push_back(static_cast<float>((i << 8) | ((i + 64) & 255)));
      columns[1].push_back(static_cast<float>(((255 - i) << 8) | ((3 * i) & 255)));
    }
    Runner once;
    const Columns out = once(*kernel, module, {}, columns, 256);
    for (std::uint32_t i = 0; i < 256; ++i) {
      const std::uint32_t bytes[] = {3 * i, 255 - i, i + 64, i};
      std::size_t at = 0;
      for (const std::uint32_t size : {8u, 16u, 32u}) {
        for (const bool odd : {false, true}) {
          for (const std::uint32_t byte : bytes) {
            EXPECT_EQ(out[at++][i], entry(permuted(byte) % size, odd)) << size << odd << " " << i;
          }
        }
      }
      if (!whole_word) continue;
      EXPECT_EQ(out[at][i], static_cast<float>(permuted(i) << 8 | permuted(i + 64)));
      EXPECT_EQ(out[at + 1][i], static_cast<float>(permuted(255 - i) << 8 | permuted(3 * i)));
    }
  }
}

// Sums and products of entries with places in a cell, and with numbers that cannot be doubled.
TEST_P(Lattice, ProductsWithEntries) {
  TestProgram program;
  ir::Module& module = program.split.module;
  ir::Builder& b = program.build;
  const std::int32_t table = add_table(module, 16, false);
  const ir::Value index = b.emit(Op::f2i, {program.input()}), x = program.input();
  const ir::Value g = b.emit(Op::table_f32, {index}, table);
  const ir::Value place = b.emit(Op::fsub, {x, b.emit(Op::ffloor, {x})});
  const ir::Value from_high = b.emit(Op::fsub, {place, b.const_f32(1)});
  for (const ir::Value factor : {place, from_high, x}) {
    program.output(b.emit(Op::fma, {g, factor, x}));
    program.output(b.emit(Op::fma, {factor, g, x}));
    program.output(b.emit(Op::fmul, {factor, g}));
    program.output(b.emit(Op::fadd, {factor, g}));
    program.output(b.emit(Op::fadd, {g, factor}));
  }
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  const float numbers[] = {0,     -0.0f, 0.25f,           0x1.fffffep-1f,   -1e-30f,   1e-42f, 7.3f,
                           -8.1f, 3e38f, 0x1.fffffep127f, -0x1.fffffep127f, HUGE_VALF, 1e-38f};
  Columns columns(2);
  for (int i = 0; i < 16; ++i) {
    for (const float number : numbers) {
      columns[0].push_back(static_cast<float>(i));
      columns[1].push_back(number);
    }
  }
  const auto count = static_cast<int>(columns[0].size());
  Runner once;
  const Columns out = once(*kernel, module, {}, columns, count);
  for (int s = 0; s < count; ++s) {
    const float e = entry(static_cast<std::uint32_t>(columns[0][s]), false), v = columns[1][s];
    const float low = v - std::floor(v);
    std::size_t at = 0;
    for (const float factor : {low, low - 1, v}) {
      const float expected[] = {std::fma(e, factor, v), std::fma(e, factor, v), e * factor,
                                e + factor, e + factor};
      for (const float value : expected) {
        if (std::isnan(value)) {
          EXPECT_TRUE(std::isnan(out[at][s])) << at << " of " << v;
        } else {
          EXPECT_EQ(bits(out[at][s]), bits(value)) << at << " of " << e << " and " << v;
        }
        ++at;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Lattice, ::testing::ValuesIn(all_machines()), machine_name);

}  // namespace
}  // namespace pse::testing_support
