// Every operator without control against answers derived by hand, edge cases included, as varying
// and uniform values.
#include <array>

#include "ir/evaluate.h"
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

class Operator : public OnEveryMachine {};

constexpr std::uint32_t inf = 0x7f800000u, minus_inf = 0xff800000u, nan1 = 0x7fc00000u, zero = 0,
                        minus_zero = 0x80000000u;
constexpr std::uint32_t tiny = 1, one = 0x3f800000u, minus_one = 0xbf800000u, huge = 0x7f7fffffu;
std::uint32_t f(float value) { return bits(value); }

struct Case {
  Op op;
  std::vector<std::uint32_t> operands;  // floats and integers as bits, booleans as 0 or 1
  std::uint32_t result;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {Op::fadd, {f(1.5f), f(2.25f)}, f(3.75f)},
      {Op::fadd, {inf, minus_inf}, nan1},
      {Op::fadd, {minus_zero, zero}, zero},
      {Op::fadd, {minus_zero, minus_zero}, minus_zero},
      {Op::fadd, {tiny, tiny}, 2},                        // subnormals are kept
      {Op::fadd, {f(16777216.0f), one}, f(16777216.0f)},  // half to even
      {Op::fadd, {f(16777216.0f), f(3.0f)}, f(16777220.0f)},
      {Op::fadd, {huge, huge}, inf},
      {Op::fsub, {one, f(1.00000012f)}, 0xb4000000u},
      {Op::fsub, {inf, inf}, nan1},
      {Op::fsub, {zero, zero}, zero},
      {Op::fsub, {minus_zero, zero}, minus_zero},
      {Op::fmul, {f(3.0f), f(-2.0f)}, f(-6.0f)},
      {Op::fmul, {zero, inf}, nan1},
      {Op::fmul, {zero, minus_one}, minus_zero},
      {Op::fmul, {0x00800000u, f(0.5f)}, 0x00400000u},  // into the subnormals
      {Op::fdiv, {one, f(3.0f)}, 0x3eaaaaabu},
      {Op::fdiv, {one, zero}, inf},
      {Op::fdiv, {one, minus_zero}, minus_inf},
      {Op::fdiv, {minus_one, zero}, minus_inf},
      {Op::fdiv, {zero, zero}, nan1},
      {Op::fdiv, {minus_zero, minus_zero}, nan1},
      // (1 + 2^-23)^2 = 1 + 2^-22 + 2^-46: with one rounding 2^-46 remains after subtracting the
      // rest
      {Op::fma, {0x3f800001u, 0x3f800001u, f(-1.0f - 0x1p-22f)}, f(0x1p-46f)},
      {Op::fma, {zero, inf, one}, nan1},
      {Op::fma, {f(2.0f), f(3.0f), f(4.0f)}, f(10.0f)},
      {Op::fneg, {zero}, minus_zero},
      {Op::fneg, {inf}, minus_inf},
      {Op::fabs, {minus_zero}, zero},
      {Op::fabs, {f(-7.5f)}, f(7.5f)},
      {Op::fabs, {minus_inf}, inf},
      {Op::fsqrt, {f(2.0f)}, 0x3fb504f3u},
      {Op::fsqrt, {minus_zero}, minus_zero},
      {Op::fsqrt, {minus_one}, nan1},
      {Op::fsqrt, {tiny}, 0x1a3504f3u},  // 2^-149 -> 2^-75 sqrt(2)
      {Op::fsqrt, {inf}, inf},
      {Op::fmin, {one, f(2.0f)}, one},
      {Op::fmin, {nan1, one}, one},
      {Op::fmin, {one, nan1}, nan1},
      {Op::fmin, {zero, minus_zero}, minus_zero},
      {Op::fmin, {minus_zero, zero}, zero},
      {Op::fmax, {one, f(2.0f)}, f(2.0f)},
      {Op::fmax, {nan1, one}, one},
      {Op::fmax, {one, nan1}, nan1},
      {Op::fmax, {zero, minus_zero}, minus_zero},
      {Op::fmax, {minus_zero, zero}, zero},
      {Op::ffloor, {f(-0.5f)}, minus_one},
      {Op::ffloor, {minus_zero}, minus_zero},
      {Op::ffloor, {f(2.75f)}, f(2.0f)},
      {Op::ffloor, {f(1e10f)}, f(1e10f)},
      {Op::ffloor, {minus_inf}, minus_inf},
      {Op::ffloor, {nan1}, nan1},
      {Op::fceil, {f(-0.5f)}, minus_zero},
      {Op::fceil, {f(0.25f)}, one},
      {Op::fceil, {tiny}, one},
      {Op::ftrunc, {f(-0.75f)}, minus_zero},
      {Op::ftrunc, {f(-3.75f)}, f(-3.0f)},
      {Op::ftrunc, {f(8388609.0f)}, f(8388609.0f)},
      {Op::fround, {f(0.5f)}, zero},
      {Op::fround, {f(1.5f)}, f(2.0f)},
      {Op::fround, {f(2.5f)}, f(2.0f)},
      {Op::fround, {f(-0.5f)}, minus_zero},
      {Op::fround, {f(-1.5f)}, f(-2.0f)},
      {Op::fround, {f(0.49999997f)}, zero},
      {Op::feq, {zero, minus_zero}, 1},
      {Op::feq, {nan1, nan1}, 0},
      {Op::feq, {one, one}, 1},
      {Op::fne, {nan1, nan1}, 1},
      {Op::fne, {zero, minus_zero}, 0},
      {Op::fne, {one, f(2.0f)}, 1},
      {Op::flt, {one, f(2.0f)}, 1},
      {Op::flt, {one, one}, 0},
      {Op::flt, {nan1, one}, 0},
      {Op::flt, {minus_zero, zero}, 0},
      {Op::flt, {zero, tiny}, 1},
      {Op::fle, {one, one}, 1},
      {Op::fle, {one, nan1}, 0},
      {Op::fle, {minus_zero, zero}, 1},
      {Op::iadd, {0xffffffffu, 2}, 1},
      {Op::iadd, {0x7fffffffu, 1}, 0x80000000u},
      {Op::isub, {0, 1}, 0xffffffffu},
      {Op::imul, {0x10001u, 0x10001u}, 0x20001u},
      {Op::imul, {0xffffffffu, 0xffffffffu}, 1},
      {Op::iand, {0xf0f0f0f0u, 0xff00ff00u}, 0xf000f000u},
      {Op::ior, {0xf0f0f0f0u, 0xff00ff00u}, 0xfff0fff0u},
      {Op::ixor, {0xf0f0f0f0u, 0xff00ff00u}, 0x0ff00ff0u},
      {Op::ishl, {0x80000001u, 1}, 2},
      {Op::ishl, {1, 31}, 0x80000000u},
      {Op::ishl, {1, 32}, 0},
      {Op::ishl, {1, 0xffffffffu}, 0},
      {Op::ishl, {5, 0}, 5},
      {Op::ishr, {0x80000000u, 31}, 1},
      {Op::ishr, {0x80000000u, 32}, 0},
      {Op::ishr, {0xffffffffu, 0xffffffe0u}, 0},
      {Op::isar, {0x80000000u, 31}, 0xffffffffu},
      {Op::isar, {0x80000000u, 32}, 0xffffffffu},
      {Op::isar, {0x7fffffffu, 100}, 0},
      {Op::isar, {0xfffffff0u, 2}, 0xfffffffcu},
      {Op::isar, {0x80000000u, 0x80000000u}, 0xffffffffu},
      {Op::ieq, {7, 7}, 1},
      {Op::ieq, {7, 8}, 0},
      {Op::ine, {7, 8}, 1},
      {Op::ine, {7, 7}, 0},
      {Op::ilt, {0xffffffffu, 0}, 1},
      {Op::ilt, {0, 0xffffffffu}, 0},
      {Op::ilt, {3, 3}, 0},
      {Op::ile, {3, 3}, 1},
      {Op::ile, {0x80000000u, 0x7fffffffu}, 1},
      {Op::band, {1, 1}, 1},
      {Op::band, {1, 0}, 0},
      {Op::bor, {0, 1}, 1},
      {Op::bor, {0, 0}, 0},
      {Op::bxor, {1, 1}, 0},
      {Op::bxor, {1, 0}, 1},
      {Op::bnot, {1}, 0},
      {Op::bnot, {0}, 1},
      {Op::f2i, {f(-1.75f)}, 0xffffffffu},
      {Op::f2i, {f(2147483520.0f)}, 2147483520u},
      {Op::f2i, {f(2147483648.0f)}, 0x80000000u},
      {Op::f2i, {f(-2147483648.0f)}, 0x80000000u},
      {Op::f2i, {f(-2147483904.0f)}, 0x80000000u},
      {Op::f2i, {nan1}, 0x80000000u},
      {Op::f2i, {inf}, 0x80000000u},
      {Op::f2i, {minus_inf}, 0x80000000u},
      {Op::f2i, {f(1e20f)}, 0x80000000u},
      {Op::i2f, {16777217u}, f(16777216.0f)},
      {Op::i2f, {16777219u}, f(16777220.0f)},
      {Op::i2f, {0xffffffffu}, minus_one},
      {Op::i2f, {0x80000000u}, f(-2147483648.0f)},
      {Op::i2f, {0x7fffffffu}, f(2147483648.0f)},
      {Op::f2bits, {minus_zero}, minus_zero},
      {Op::f2bits, {one}, one},
      {Op::f2bits, {tiny}, 1},
      {Op::bits2f, {one}, one},
      {Op::bits2f, {0x80000001u}, 0x80000001u},
      {Op::bits2f, {0xff812345u}, nan1},
      {Op::bytes_add, {0xff01807fu, 0x02ff8001u}, 0x01000080u},
  };
  return all;
}

ir::Value operand(TestProgram& program, char letter, ir::Rate rate) {
  if (letter == 'f') return program.input(rate);
  if (letter == 'i') return program.input_int(rate);
  return program.build.emit(Op::fne, {program.input(rate), program.build.const_f32(0)});
}

// The columns an operand takes.
void append(std::vector<float>& row, char letter, std::uint32_t value) {
  if (letter == 'f') row.push_back(from_bits(value));
  if (letter == 'b') row.push_back(value != 0 ? 1.0f : 0.0f);
  if (letter == 'i') {
    row.push_back(static_cast<float>(value >> 16));
    row.push_back(static_cast<float>(value & 0xffffu));
  }
}

void emit_case(TestProgram& program, Op op, ir::Rate rate) {
  std::vector<ir::Value> o;
  for (const char letter : ir::info(op).operands) o.push_back(operand(program, letter, rate));
  const ir::Value result = o.size() == 1   ? program.build.emit(op, {o[0]})
                           : o.size() == 2 ? program.build.emit(op, {o[0], o[1]})
                                           : program.build.emit(op, {o[0], o[1], o[2]});
  const char letter = ir::info(op).results.front();
  if (letter == 'f') program.output(result);
  if (letter == 'i') program.output_int(result);
  if (letter == 'b') program.output_bool(result);
}

std::vector<Case> cases_of(Op op) {
  std::vector<Case> result;
  for (const Case& c : cases()) {
    if (c.op == op) result.push_back(c);
  }
  return result;
}

// One program with all operators; operator by operator, sample i computes case i.
struct AllOperators {
  TestProgram program;
  Columns columns;
  std::size_t longest = 0;

  explicit AllOperators(ir::Rate rate) {
    for (const ir::OpInfo& info : ir::op_table()) {
      const std::vector<Case> these = cases_of(info.op);
      if (these.empty()) continue;
      const std::size_t first = program.split.module.inputs.size();
      emit_case(program, info.op, rate);
      columns.resize(program.split.module.inputs.size());
      for (const Case& c : these) {
        std::vector<float> row;
        for (std::size_t i = 0; i < c.operands.size(); ++i)
          append(row, info.operands[i], c.operands[i]);
        for (std::size_t i = 0; i < row.size(); ++i) columns[first + i].push_back(row[i]);
      }
      longest = std::max(longest, these.size());
    }
    for (auto& column : columns) column.resize(longest);
    program.finish();
  }

  void expect_case(const Columns& out, std::size_t sample, std::size_t number) const {
    std::size_t column = 0;
    for (const ir::OpInfo& info : ir::op_table()) {
      const std::vector<Case> these = cases_of(info.op);
      if (these.empty()) continue;
      const char letter = info.results.front();
      std::uint32_t result = bits(out[column][sample]);
      if (letter == 'b') result = out[column][sample] != 0 ? 1 : 0;
      if (letter == 'i') {
        result = static_cast<std::uint32_t>(out[column][sample]) << 16;
        result |= static_cast<std::uint32_t>(out[++column][sample]);
      }
      ++column;
      if (number < these.size()) {
        EXPECT_EQ(result, these[number].result) << info.name << " case " << number;
      }
    }
  }
};

TEST_P(Operator, GivesTheTablesBits) {
  const AllOperators all(ir::Rate::sample);
  const Columns out =
      run(all.program, GetParam(), all.columns, static_cast<std::int64_t>(all.longest));
  for (std::size_t i = 0; i < all.longest; ++i) all.expect_case(out, i, i);
}

// The same with operands that hold for a frame: the operator then works on scalars.
TEST_P(Operator, GivesTheTablesBitsForUniformValues) {
  const AllOperators all(ir::Rate::frame);
  const auto kernel = compile(all.program, GetParam());
  ASSERT_TRUE(kernel);
  for (std::size_t i = 0; i < all.longest; ++i) {
    std::vector<float> uniforms;
    for (const auto& column : all.columns) uniforms.push_back(column[i]);
    Runner once;
    const Columns out = once(*kernel, all.program.split.module, uniforms, {}, 3);
    for (std::size_t sample = 0; sample < 3; ++sample) all.expect_case(out, sample, i);
  }
}

// The edges of each type; every operator meets all of their combinations.
std::vector<std::uint32_t> awkward(char letter) {
  if (letter == 'b') return {0, 1};
  if (letter == 'f')
    return {zero,          minus_zero, one, minus_one, f(0.5f), f(-2.5f),         tiny,
            0x807fffffu,   huge,       inf, minus_inf, nan1,    f(2147483648.0f), f(-2147483648.0f),
            f(8388609.0f), f(1e-30f)};
  return {0, 1, 2, 5, 31, 32, 33, 0x7fffffffu, 0x80000000u, 0x80000001u, 0xffffffffu, 0x00ff80f1u};
}

// What it computes is what ir/evaluate.h says, with all awkward values for all operands.
TEST(Operators, TheFirstTierMeansTheSameForAllAwkwardValues) {
  if (!host_target() || !host_target()->avx2) GTEST_SKIP() << "a processor without AVX2";
  for (const ir::OpInfo& info : ir::op_table()) {
    if (!ir::is_scalar(info.op) || info.op == Op::select) continue;
    TestProgram program;
    emit_case(program, info.op, ir::Rate::sample);
    program.finish();

    // One sample for each combination.
    std::vector<std::array<std::uint32_t, 3>> samples = {{0, 0, 0}};
    for (std::size_t o = 0; o < info.operands.size(); ++o) {
      std::vector<std::array<std::uint32_t, 3>> longer;
      for (auto sample : samples)
        for (const std::uint32_t value : awkward(info.operands[o]))
          sample[o] = value, longer.push_back(sample);
      samples = std::move(longer);
    }
    Columns columns(program.split.module.inputs.size());
    for (const auto& sample : samples) {
      std::vector<float> row;
      for (std::size_t o = 0; o < info.operands.size(); ++o)
        append(row, info.operands[o], sample[o]);
      for (std::size_t i = 0; i < row.size(); ++i) columns[i].push_back(row[i]);
    }
    const Columns out =
        run(program, {8, first_tier}, columns, static_cast<std::int64_t>(samples.size()));
    const char letter = info.results.front();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto& [a, b, c] = samples[i];
      // The bits of a NaN are nobody's business.
      if (info.op == Op::f2bits && ir::is_nan_bits(a)) continue;
      std::uint32_t found = bits(out[0][i]);
      if (letter == 'b') found = out[0][i] != 0 ? 1 : 0;
      if (letter == 'i')
        found = static_cast<std::uint32_t>(out[0][i]) << 16 | static_cast<std::uint32_t>(out[1][i]);
      const ir::Bits meant = ir::evaluate(info.op, a, b, c);
      ASSERT_EQ(found, letter == 'f' ? ir::canonical(meant) : meant)
          << info.name << std::hex << " of " << a << ", " << b << ", " << c;
    }
  }
}

TEST(Operators, EveryOneOfTheTableIsTested) {
  for (const ir::OpInfo& info : ir::op_table()) {
    if (info.op <= Op::input || info.op >= Op::table_f32 || info.op == Op::select) continue;
    if (info.op == Op::slope) continue;  // gone before there is a kernel
    EXPECT_FALSE(cases_of(info.op).empty()) << info.name;
  }
}

TEST_P(Operator, SelectComputesBothAndChooses) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), y = program.input();
  program.output(b.emit(Op::select, {b.emit(Op::flt, {x, y}), x, b.const_f32(-0.0f)}));
  program.finish();
  const Columns out = run(program, GetParam(), {{1, 2, 3, from_bits(nan1)}, {2, 2, 4, 1}}, 4);
  const std::vector<float> expected = {1, -0.0f, 3, -0.0f};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(bits(out[0][i]), bits(expected[i]));
}

TEST_P(Operator, OutputsStoreTheOneNaN) {
  TestProgram program;
  program.output(program.input());
  program.output(program.build.const_f32(from_bits(0xffc00001u)));
  program.finish();
  const Columns out =
      run(program, GetParam(), {{from_bits(0xffffffffu), from_bits(0x7f800001u), 1.0f}}, 3);
  EXPECT_EQ(bits(out[0][0]), nan_bits);
  EXPECT_EQ(bits(out[0][1]), nan_bits);
  EXPECT_EQ(out[0][2], 1.0f);
  EXPECT_EQ(bits(out[1][2]), nan_bits);
}

// a * b + c as two operators is rounded twice, whatever the processor has.
TEST_P(Operator, NothingIsContracted) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), y = program.input(), z = program.input();
  program.output(b.emit(Op::fadd, {b.emit(Op::fmul, {x, y}), z}));
  program.finish();
  const float a = from_bits(0x3f800001u);
  const Columns out = run(program, GetParam(), {{a}, {a}, {-1.0f - 0x1p-22f}}, 1);
  EXPECT_EQ(out[0][0], 0.0f);
}

INSTANTIATE_TEST_SUITE_P(All, Operator, ::testing::ValuesIn(all_machines()), machine_name);

}  // namespace
}  // namespace pse::testing_support
