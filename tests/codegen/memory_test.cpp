// Tables and arrays: every entry of every size, indices in and out of bounds, lengths that differ
// between samples.
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

class Memory : public OnEveryMachine {};

std::vector<float> counting(int n, float start = 0) {
  std::vector<float> result;
  for (int i = 0; i < n; ++i) result.push_back(start + static_cast<float>(i));
  return result;
}

TEST_P(Memory, TablesOfEverySize) {
  for (const int size : {1, 2, 4, 8, 16, 32, 64, 256}) {
    TestProgram program;
    ir::Module& module = program.split.module;
    module.float_tables.push_back({"f", {}});
    module.int_tables.push_back({"i", {}});
    for (int i = 0; i < size; ++i) {
      module.float_tables[0].entries.push_back(static_cast<float>(i * i) - 0.5f);
      module.int_tables[0].entries.push_back(i * 77777 - 1000000);
    }
    ir::Builder& b = program.build;
    const ir::Value index = b.emit(Op::f2i, {program.input()}),
                    same = b.emit(Op::f2i, {program.input(ir::Rate::frame)});
    program.output(b.emit(Op::table_f32, {index}));
    program.output_int(b.emit(Op::table_i32, {index}));
    program.output(b.emit(Op::table_f32, {same}));
    program.output_int(b.emit(Op::table_i32, {same}));
    program.finish();
    const auto kernel = compile(program, GetParam());
    ASSERT_TRUE(kernel);
    Runner once;
    const int count = 2 * size + 5;
    const Columns out =
        once(*kernel, module, {0, -1}, {counting(count, static_cast<float>(-size - 3))}, count);
    for (int s = 0; s < count; ++s) {
      const int entry = ((s - size - 3) % size + size) % size;
      const auto whole = static_cast<std::uint32_t>(entry * 77777 - 1000000);
      const auto last = static_cast<std::uint32_t>((size - 1) * 77777 - 1000000);
      EXPECT_EQ(out[0][s], static_cast<float>(entry * entry) - 0.5f) << size << " " << s;
      EXPECT_EQ(out[1][s], static_cast<float>(whole >> 16)) << size << " " << s;
      EXPECT_EQ(out[2][s], static_cast<float>(whole & 0xffff)) << size << " " << s;
      EXPECT_EQ(out[3][s], static_cast<float>((size - 1) * (size - 1)) - 0.5f);
      EXPECT_EQ(out[4][s], static_cast<float>(last >> 16));
    }
  }
}

TEST_P(Memory, BytesAreLookedUpOneByOne) {
  TestProgram program;
  ir::Module& module = program.split.module;
  module.byte_tables.push_back({"b", {}});
  for (int i = 0; i < 256; ++i)
    module.byte_tables[0].entries.push_back(static_cast<std::uint8_t>(i * 167 + 13));
  ir::Builder& b = program.build;
  program.output_int(b.emit(Op::bytes_lookup, {program.input_int(ir::Rate::sample)}));
  program.output_int(b.emit(Op::bytes_lookup, {program.input_int(ir::Rate::frame)}));
  program.finish();
  const auto entry = [](int i) { return static_cast<std::uint32_t>((i & 255) * 167 + 13) & 255u; };
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  Runner once;
  // The four bytes i, i + 64, 255 - i, 3 i: every entry in every place.
  Columns columns(2);
  for (int i = 0; i < 256; ++i) {
    columns[0].push_back(static_cast<float>((i << 8) | ((i + 64) & 255)));
    columns[1].push_back(static_cast<float>(((255 - i) << 8) | ((3 * i) & 255)));
  }
  const Columns out = once(*kernel, module, {0, 0, 0x80ff, 0x007f}, columns, 256);
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ(out[0][i], static_cast<float>(entry(i) << 8 | entry(i + 64))) << i;
    EXPECT_EQ(out[1][i], static_cast<float>(entry(255 - i) << 8 | entry(3 * i))) << i;
    EXPECT_EQ(out[2][i], static_cast<float>(entry(0x80) << 8 | entry(0xff)));
    EXPECT_EQ(out[3][i], static_cast<float>(entry(0) << 8 | entry(0x7f)));
  }
}

// Two components, capacity 5, two elements at the start.
void declare(TestProgram& program, ir::Rate rate) {
  for (std::size_t f = 0; f < 2; ++f) {
    program.split.module.functions[f].arrays = {{"pad", 1, 3, rate, 0}, {"a", 2, 5, rate, 2}};
  }
}

// Resizes to n, stores (x, -x) at element i, loads at element j; i, j, n vary or not.
void emit_use(TestProgram& program, ir::Rate index_rate) {
  declare(program, ir::Rate::sample);
  ir::Builder& b = program.build;
  const ir::Value x = program.input();
  const ir::Value n = b.emit(Op::f2i, {program.input(index_rate)});
  const ir::Value i = b.emit(Op::f2i, {program.input(index_rate)}),
                  j = b.emit(Op::f2i, {program.input(index_rate)});
  b.emit_void(Op::array_resize, {n}, 1);
  b.emit_void(Op::array_store, {i, x}, 1, 0);
  b.emit_void(Op::array_store, {i, b.emit(Op::fneg, {x})}, 1, 1);
  program.output(b.emit(Op::array_load, {j}, 1, 0));
  program.output(b.emit(Op::array_load, {j}, 1, 1));
  program.output(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 1)}));
  program.output(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 0)}));
  program.finish();
}

struct Use {
  int n, i, j;
  bool hit;  // element j holds x afterwards
  int length;
};
constexpr Use uses[] = {
    {4, 3, 3, true, 4},   {4, 3, 2, false, 4},       {4, 4, 4, false, 4},
    {5, 4, 4, true, 5},   {9, 4, 4, true, 5},        {9, 5, 5, false, 5},
    {-1, 0, 0, false, 0}, {1, 0, 0, true, 1},        {2, -1, 0, false, 2},
    {2, 0, -1, false, 2}, {5, 1000000, 4, false, 5}, {5, 2, 2000000000, false, 5},
    {0, 2, 2, false, 0},  {3, 2, 2, true, 3}};

TEST_P(Memory, ArraysWithVaryingIndices) {
  TestProgram program;
  emit_use(program, ir::Rate::sample);
  Columns columns(4);
  for (const Use& use : uses) {
    columns[0].push_back(static_cast<float>(columns[0].size() + 1));
    columns[1].push_back(static_cast<float>(use.n));
    columns[2].push_back(static_cast<float>(use.i));
    columns[3].push_back(static_cast<float>(use.j));
  }
  const Columns out = run(program, GetParam(), columns, std::ssize(uses));
  for (std::size_t s = 0; s < std::size(uses); ++s) {
    EXPECT_EQ(out[0][s], uses[s].hit ? columns[0][s] : 0.0f) << s;
    EXPECT_EQ(out[1][s], uses[s].hit ? -columns[0][s] : 0.0f) << s;
    EXPECT_EQ(out[2][s], static_cast<float>(uses[s].length)) << s;
    EXPECT_EQ(out[3][s], 0.0f);
  }
}

TEST_P(Memory, ArraysWithUniformIndices) {
  TestProgram program;
  emit_use(program, ir::Rate::frame);
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  for (const Use& use : uses) {
    Runner once;
    const std::vector<float> uniforms = {0, static_cast<float>(use.n), static_cast<float>(use.i),
                                         static_cast<float>(use.j)};
    // Twice: a second vector of samples must not see the first one's elements.
    const Columns out = once(*kernel, program.split.module, uniforms, {counting(40, 1)}, 40);
    for (std::size_t s = 0; s < 40; ++s) {
      EXPECT_EQ(out[0][s], use.hit ? static_cast<float>(s + 1) : 0.0f) << use.n << use.i << use.j;
      EXPECT_EQ(out[2][s], static_cast<float>(use.length));
    }
  }
}

// Stores and resizes inside a varying if reach only the samples that are there.
TEST_P(Memory, ArraysUnderAMask) {
  TestProgram program;
  declare(program, ir::Rate::sample);
  ir::Builder& b = program.build;
  const ir::Value x = program.input();
  b.emit_void(Op::array_store, {b.const_i32(1), b.const_f32(7)}, 1, 0);
  ir::Region yes, no;
  b.begin_region(yes);
  b.emit_void(Op::array_store, {b.const_i32(1), x}, 1, 0);
  b.emit_void(Op::array_store, {b.emit(Op::f2i, {x}), b.const_f32(9)}, 1, 1);
  b.emit_void(Op::array_resize, {b.const_i32(4)}, 1);
  b.end_region();
  b.emit_if(b.emit(Op::flt, {x, b.const_f32(3)}), std::move(yes), std::move(no));
  program.output(b.emit(Op::array_load, {b.const_i32(1)}, 1, 0));
  program.output(b.emit(Op::array_load, {b.const_i32(1)}, 1, 1));
  program.output(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 1)}));
  program.finish();
  const Columns out = run(program, GetParam(), {counting(20)}, 20);
  for (int s = 0; s < 20; ++s) {
    EXPECT_EQ(out[0][s], s < 3 ? static_cast<float>(s) : 7.0f);
    EXPECT_EQ(out[1][s], s == 1 ? 9.0f : 0.0f);
    EXPECT_EQ(out[2][s], s < 3 ? 4.0f : 2.0f);
  }
}

// Shrinking and growing again gives zeros.
TEST_P(Memory, NewElementsAreZero) {
  TestProgram program;
  declare(program, ir::Rate::sample);
  ir::Builder& b = program.build;
  const ir::Value n = b.emit(Op::f2i, {program.input()});
  b.emit_void(Op::array_resize, {b.const_i32(5)}, 1);
  for (int i = 0; i < 5; ++i)
    b.emit_void(Op::array_store, {b.const_i32(i), b.const_f32(static_cast<float>(i + 1))}, 1, 0);
  b.emit_void(Op::array_resize, {n}, 1);
  b.emit_void(Op::array_resize, {b.const_i32(5)}, 1);
  for (int i = 0; i < 5; ++i) program.output(b.emit(Op::array_load, {b.const_i32(i)}, 1, 0));
  program.finish();
  const Columns out = run(program, GetParam(), {counting(6)}, 6);
  for (int s = 0; s < 6; ++s) {
    for (int i = 0; i < 5; ++i) EXPECT_EQ(out[i][s], i < s ? static_cast<float>(i + 1) : 0.0f);
  }
}

// The frame function fills arrays and slots; samples read them, by uniform and varying indices.
TEST_P(Memory, FrameArraysAndSlots) {
  TestProgram program;
  declare(program, ir::Rate::frame);
  ir::Module& module = program.split.module;
  ir::Builder& b = program.build;
  const ir::Value j = b.emit(Op::f2i, {program.input()});
  const ir::Value knob = program.input(ir::Rate::frame);
  static_cast<void>(knob);
  program.finish();
  module.inputs.push_back({"$slot.0", ir::Rate::frame});
  module.inputs.push_back({"$slot.1", ir::Rate::frame});
  {
    ir::Function& frame = module.functions[1];
    ir::Builder f(module, frame);
    const ir::Value k = f.emit(Op::input, {}, 1);
    f.emit_void(Op::array_resize, {f.const_i32(3)}, 1);
    f.emit_void(Op::array_store, {f.const_i32(0), k}, 1, 0);
    f.emit_void(Op::array_store, {f.const_i32(2), f.const_f32(5)}, 1, 1);
    f.emit_void(Op::array_store, {f.const_i32(5), f.const_f32(1)}, 1, 1);
    f.emit_void(Op::array_store, {f.const_i32(-1), f.const_f32(1)}, 1, 1);
    frame.body.yields = {f.emit(Op::fadd, {k, f.const_f32(1)}),
                         f.emit(Op::bits2f, {f.const_i32(0x7f812345)})};
  }
  program.output(b.emit(Op::array_load, {j}, 1, 0));
  program.output(b.emit(Op::array_load, {j}, 1, 1));
  program.output(b.emit(Op::array_load, {b.const_i32(2)}, 1, 1));
  program.output(b.emit(Op::array_load, {b.const_i32(3)}, 1, 1));
  program.output(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 1)}));
  program.output(b.emit(Op::input, {}, 2));
  program.output_int(b.emit(Op::f2bits, {b.emit(Op::input, {}, 3)}));
  program.output(b.emit(Op::array_load, {j}, 0, 0));
  for (const bool compile_frame : {true, false}) {
    const auto kernel = compile(program, GetParam(), true, compile_frame);
    ASSERT_TRUE(kernel);
    Runner once;
    const Columns out = once(*kernel, module, {0, 42}, {counting(9, -2)}, 9);
    for (int s = 0; s < 9; ++s) {
      EXPECT_EQ(out[0][s], s == 2 ? 42.0f : 0.0f);
      EXPECT_EQ(out[1][s], s == 4 ? 5.0f : 0.0f);
      EXPECT_EQ(out[2][s], 5.0f);
      EXPECT_EQ(out[3][s], 0.0f);
      EXPECT_EQ(out[4][s], 3.0f);
      EXPECT_EQ(out[5][s], 43.0f);
      EXPECT_EQ(out[6][s], static_cast<float>(0x7f81));  // integers keep their bits in a slot
      EXPECT_EQ(out[7][s], static_cast<float>(0x2345));
      EXPECT_EQ(out[8][s], 0.0f);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Memory, ::testing::ValuesIn(all_machines()), machine_name);

}  // namespace
}  // namespace pse::testing_support
