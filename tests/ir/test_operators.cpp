// Each operator on operands whose answers were worked out by hand from IEEE 754 and the sentences
// of ops.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "ir/builder.h"
#include "ir/interpreter.h"

namespace pse::ir {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float largest = std::numeric_limits<float>::max();
constexpr float smallest = std::numeric_limits<float>::denorm_min();  // 2^-149
constexpr float normal = std::numeric_limits<float>::min();           // 2^-126
constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t high = std::numeric_limits<std::int32_t>::max();

// An operand or answer of any type.
struct Any {
  Type type;
  Bits bits;
  Any(float value) : type(Type::f32), bits(to_bits(value)) {}
  Any(int value) : type(Type::i32), bits(static_cast<Bits>(value)) {}
  Any(unsigned value) : type(Type::i32), bits(value) {}
  Any(bool value) : type(Type::boolean), bits(value) {}
};

struct Case {
  Op op;
  std::vector<Any> operands;
  Any answer;
  std::int32_t imm = 0;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> table = {
      {Op::fadd, {1.5f, 2.25f}, 3.75f},
      {Op::fadd, {16777216.0f, 1.0f}, 16777216.0f},  // halfway: to even
      {Op::fadd, {16777218.0f, 1.0f}, 16777220.0f},  // halfway: to even, upward
      {Op::fadd, {-0.0f, -0.0f}, -0.0f},
      {Op::fadd, {-0.0f, 0.0f}, 0.0f},
      {Op::fadd, {1.0f, -1.0f}, 0.0f},
      {Op::fadd, {inf, -inf}, nan},
      {Op::fadd, {inf, largest}, inf},
      {Op::fadd, {largest, largest}, inf},
      {Op::fadd, {nan, 1.0f}, nan},
      {Op::fadd, {smallest, smallest}, 2 * smallest},  // subnormals are kept
      {Op::fsub, {5.0f, 7.5f}, -2.5f},
      {Op::fsub, {0.0f, 0.0f}, 0.0f},
      {Op::fsub, {-0.0f, 0.0f}, -0.0f},
      {Op::fsub, {inf, inf}, nan},
      {Op::fsub, {normal, smallest}, std::nextafter(normal, 0.0f)},
      {Op::fmul, {3.0f, -2.0f}, -6.0f},
      {Op::fmul, {0.0f, -2.0f}, -0.0f},
      {Op::fmul, {0.0f, inf}, nan},
      {Op::fmul, {largest, 2.0f}, inf},
      {Op::fmul, {smallest, 0.5f}, 0.0f},  // halfway: to even
      {Op::fmul, {smallest, 0.75f}, smallest},
      {Op::fmul, {16777215.0f, 16777215.0f}, 281474943156224.0f},  // 2^48 - 2^25 + 1
      {Op::fdiv, {1.0f, 3.0f}, 11184811.0f / 33554432.0f},         // 0x3eaaaaab
      {Op::fdiv, {1.0f, 0.0f}, inf},
      {Op::fdiv, {1.0f, -0.0f}, -inf},
      {Op::fdiv, {-1.0f, 0.0f}, -inf},
      {Op::fdiv, {0.0f, 0.0f}, nan},
      {Op::fdiv, {inf, inf}, nan},
      {Op::fdiv, {1.0f, -inf}, -0.0f},
      {Op::fdiv, {smallest, 2.0f}, 0.0f},
      // (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24: fused keeps the last term, rounded apart loses it.
      {Op::fma, {1.0f + 0x1p-12f, 1.0f + 0x1p-12f, -1.0f - 0x1p-11f}, 0x1p-24f},
      {Op::fma, {0.0f, inf, 1.0f}, nan},
      {Op::fma, {2.0f, 3.0f, 4.0f}, 10.0f},
      {Op::fma, {0.0f, -1.0f, 0.0f}, 0.0f},
      {Op::fma, {0.0f, -1.0f, -0.0f}, -0.0f},
      {Op::fma, {largest, 2.0f, -largest}, largest},  // the product does not overflow on the way
      {Op::fneg, {1.0f}, -1.0f},
      {Op::fneg, {0.0f}, -0.0f},
      {Op::fneg, {-inf}, inf},
      {Op::fneg, {nan}, nan},
      {Op::fabs, {-0.0f}, 0.0f},
      {Op::fabs, {-inf}, inf},
      {Op::fabs, {-smallest}, smallest},
      {Op::fabs, {nan}, nan},
      {Op::fsqrt, {4.0f}, 2.0f},
      {Op::fsqrt, {2.0f}, 11863283.0f / 8388608.0f},  // 0x3fb504f3
      {Op::fsqrt, {-0.0f}, -0.0f},
      {Op::fsqrt, {-1.0f}, nan},
      {Op::fsqrt, {-smallest}, nan},
      {Op::fsqrt, {inf}, inf},
      {Op::fsqrt, {0x1p-148f}, 0x1p-74f},
      {Op::fmin, {1.0f, 2.0f}, 1.0f},
      {Op::fmin, {nan, 2.0f}, 2.0f},
      {Op::fmin, {2.0f, nan}, nan},
      {Op::fmin, {-0.0f, 0.0f}, 0.0f},
      {Op::fmin, {0.0f, -0.0f}, -0.0f},
      {Op::fmin, {inf, -inf}, -inf},
      {Op::fmax, {1.0f, 2.0f}, 2.0f},
      {Op::fmax, {nan, 2.0f}, 2.0f},
      {Op::fmax, {2.0f, nan}, nan},
      {Op::fmax, {-0.0f, 0.0f}, 0.0f},
      {Op::fmax, {0.0f, -0.0f}, -0.0f},
      {Op::ffloor, {-0.5f}, -1.0f},
      {Op::ffloor, {2.999f}, 2.0f},
      {Op::ffloor, {-0.0f}, -0.0f},
      {Op::ffloor, {-smallest}, -1.0f},
      {Op::ffloor, {-inf}, -inf},
      {Op::ffloor, {nan}, nan},
      {Op::ffloor, {8388609.0f}, 8388609.0f},
      {Op::ffloor, {3e9f}, 3e9f},
      {Op::fceil, {-0.5f}, -0.0f},
      {Op::fceil, {smallest}, 1.0f},
      {Op::fceil, {2.001f}, 3.0f},
      {Op::fceil, {-0.0f}, -0.0f},
      {Op::fceil, {inf}, inf},
      {Op::fceil, {nan}, nan},
      {Op::ftrunc, {-2.75f}, -2.0f},
      {Op::ftrunc, {-0.75f}, -0.0f},
      {Op::ftrunc, {2.75f}, 2.0f},
      {Op::ftrunc, {-inf}, -inf},
      {Op::ftrunc, {nan}, nan},
      {Op::fround, {0.5f}, 0.0f},
      {Op::fround, {1.5f}, 2.0f},
      {Op::fround, {2.5f}, 2.0f},
      {Op::fround, {-0.5f}, -0.0f},
      {Op::fround, {-1.5f}, -2.0f},
      {Op::fround, {0.49999997f}, 0.0f},
      {Op::fround, {8388607.5f}, 8388608.0f},
      {Op::fround, {inf}, inf},
      {Op::fround, {nan}, nan},
      {Op::feq, {0.0f, -0.0f}, true},
      {Op::feq, {nan, nan}, false},
      {Op::feq, {smallest, 0.0f}, false},
      {Op::feq, {inf, inf}, true},
      {Op::fne, {0.0f, -0.0f}, false},
      {Op::fne, {nan, nan}, true},
      {Op::fne, {1.0f, 2.0f}, true},
      {Op::flt, {-0.0f, 0.0f}, false},
      {Op::flt, {1.0f, 2.0f}, true},
      {Op::flt, {2.0f, 1.0f}, false},
      {Op::flt, {nan, 1.0f}, false},
      {Op::flt, {1.0f, nan}, false},
      {Op::flt, {0.0f, smallest}, true},
      {Op::flt, {-inf, -largest}, true},
      {Op::fle, {-0.0f, 0.0f}, true},
      {Op::fle, {0.0f, -0.0f}, true},
      {Op::fle, {2.0f, 1.0f}, false},
      {Op::fle, {nan, nan}, false},
      {Op::iadd, {high, 1}, low},
      {Op::iadd, {low, -1}, high},
      {Op::isub, {low, 1}, high},
      {Op::isub, {0, low}, low},
      {Op::imul, {65536, 65536}, 0},
      {Op::imul, {low, -1}, low},
      {Op::imul, {-3, 7}, -21},
      {Op::iand, {12, 10}, 8},
      {Op::iand, {-1, low}, low},
      {Op::ior, {12, 10}, 14},
      {Op::ixor, {12, 10}, 6},
      {Op::ixor, {-1, high}, low},
      {Op::ishl, {1, 31}, low},
      {Op::ishl, {1, 32}, 0},
      {Op::ishl, {1, -1}, 0},
      {Op::ishl, {-1, 4}, -16},
      {Op::ishr, {-1, 28}, 15},
      {Op::ishr, {-1, 0}, -1},
      {Op::ishr, {-1, 32}, 0},
      {Op::ishr, {low, 31}, 1},
      {Op::ishr, {-1, low}, 0},
      {Op::isar, {-16, 2}, -4},
      {Op::isar, {low, 31}, -1},
      {Op::isar, {low, 32}, -1},
      {Op::isar, {-5, -1}, -1},
      {Op::isar, {5, 99}, 0},
      {Op::isar, {high, 30}, 1},
      {Op::ieq, {3, 3}, true},
      {Op::ieq, {3, 4}, false},
      {Op::ine, {3, 4}, true},
      {Op::ine, {3, 3}, false},
      {Op::ilt, {low, high}, true},
      {Op::ilt, {-1, 0}, true},
      {Op::ilt, {0, -1}, false},
      {Op::ilt, {5, 5}, false},
      {Op::ile, {5, 5}, true},
      {Op::ile, {high, low}, false},
      {Op::band, {true, false}, false},
      {Op::band, {true, true}, true},
      {Op::bor, {true, false}, true},
      {Op::bor, {false, false}, false},
      {Op::bxor, {true, true}, false},
      {Op::bxor, {true, false}, true},
      {Op::bnot, {true}, false},
      {Op::bnot, {false}, true},
      {Op::select, {true, 1.0f, 2.0f}, 1.0f},
      {Op::select, {false, 1.0f, nan}, nan},
      {Op::select, {false, 1, 2}, 2},
      {Op::select, {true, false, true}, false},
      {Op::f2i, {2.99f}, 2},
      {Op::f2i, {-2.99f}, -2},
      {Op::f2i, {2147483520.0f}, 2147483520},
      {Op::f2i, {2147483648.0f}, low},
      {Op::f2i, {-2147483648.0f}, low},
      {Op::f2i, {-2147483904.0f}, low},
      {Op::f2i, {inf}, low},
      {Op::f2i, {-inf}, low},
      {Op::f2i, {nan}, low},
      {Op::f2i, {-0.0f}, 0},
      {Op::i2f, {16777217}, 16777216.0f},  // halfway: to even
      {Op::i2f, {16777219}, 16777220.0f},
      {Op::i2f, {high}, 2147483648.0f},
      {Op::i2f, {low}, -2147483648.0f},
      {Op::i2f, {0}, 0.0f},
      {Op::f2bits, {1.0f}, 0x3f800000},
      {Op::f2bits, {-0.0f}, low},
      {Op::f2bits, {smallest}, 1},
      {Op::bits2f, {0x7f800000}, inf},
      {Op::bits2f, {1}, smallest},
      {Op::bits2f, {-1}, nan},
      {Op::table_f32, {0}, 10.0f},
      {Op::table_f32, {3}, 13.0f},
      {Op::table_f32, {6}, 12.0f},
      {Op::table_f32, {-1}, 13.0f},
      {Op::table_f32, {low}, 10.0f},
      {Op::table_f32, {77}, 0.25f, 1},  // a table of one entry
      {Op::table_i32, {5}, 200},
      {Op::table_i32, {-2}, -100},
      {Op::bytes_add, {0x01ff7f80, 0x01010180}, 0x02008000},
      {Op::bytes_add, {-1, -1}, 0xfefefefeu},
      {Op::bytes_lookup, {0x00010203}, 0xfffefdfcu},  // table: 255 - i
      {Op::bytes_lookup, {0xff800040u}, 0x007fffbf},
  };
  return table;
}

Module module_with_tables() {
  Module module;
  module.float_tables = {{"four", {10, 11, 12, 13}}, {"one", {0.25f}}};
  module.int_tables = {{"two", {-100, 200}}};
  ByteTable bytes{.name = "reverse"};
  for (int i = 0; i < 256; ++i) bytes.entries.push_back(static_cast<std::uint8_t>(255 - i));
  module.byte_tables = {bytes};
  module.functions.push_back({.name = "main"});
  return module;
}

Value constant(Builder& b, const Any& any) {
  if (any.type == Type::f32) return b.const_f32(to_f32(any.bits));
  if (any.type == Type::i32) return b.const_i32(static_cast<std::int32_t>(any.bits));
  return b.const_bool(any.bits != 0);
}

TEST(Operators, GiveTheAnswersWorkedOutByHand) {
  for (const Case& example : cases()) {
    Module module = module_with_tables();
    Builder b(module, module.main());
    std::vector<Value> v;
    for (const Any& operand : example.operands) v.push_back(constant(b, operand));
    const Value result = v.size() == 1   ? b.emit(example.op, {v[0]}, example.imm)
                         : v.size() == 2 ? b.emit(example.op, {v[0], v[1]}, example.imm)
                                         : b.emit(example.op, {v[0], v[1], v[2]}, example.imm);
    EXPECT_EQ(b.type(result), example.answer.type) << info(example.op).name;
    module.main().body.yields = {result};
    const auto index = &example - cases().data();
    const Any& answer = example.answer;
    EXPECT_EQ(interpret(module, 0, {}).results[0],
              answer.type == Type::f32 ? canonical(answer.bits) : answer.bits)
        << info(example.op).name << ", case " << index;
  }
}

TEST(Operators, AllThatComputeHaveCases) {
  std::set<Op> tested;
  for (const Case& example : cases()) tested.insert(example.op);
  for (const OpInfo& op : op_table()) {
    const bool computes = op.op >= Op::fadd && op.op <= Op::bytes_lookup;
    EXPECT_TRUE(!computes || tested.contains(op.op)) << op.name;
  }
}

// Runs what `write` emits, and gives the outcome and results.
template <typename Write>
Interpreted run(const Write& write, std::vector<Array> arrays = {},
                std::uint64_t max_turns = 1000) {
  Module module = module_with_tables();
  module.inputs = {{"x", Rate::sample}, {"time", Rate::frame}};
  module.checks = {{{}, "zeroth"}, {{}, "first"}};
  module.externals = {{"sum and product", 2, 2}};
  module.main().arrays = std::move(arrays);
  Builder b(module, module.main());
  module.main().body.yields = write(b);
  const std::vector<float> inputs = {7.0f, 9.0f};
  const ExternalCallback external = [](std::uint32_t, std::span<const float> a,
                                       std::span<float> r) {
    r[0] = a[0] + a[1];
    r[1] = a[0] * a[1];
  };
  return interpret(module, 0, inputs, &external, max_turns);
}

TEST(Interpreter, ReadsInputsAndCallsExternals) {
  const auto result = run([](Builder& b) {
    const Type types[] = {Type::f32, Type::f32};
    return b.emit_multi(Op::external,
                        std::vector{b.emit(Op::input, {}, 0), b.emit(Op::input, {}, 1)}, types, 0);
  });
  EXPECT_EQ(result.results, (std::vector<Bits>{to_bits(16.0f), to_bits(63.0f)}));
}

TEST(Interpreter, ArraysAreBoundedAndGrowWithZeros) {
  const auto result = run(
      [](Builder& b) {
        const auto at = [&](int i) { return b.const_i32(i); };
        std::vector<Value> seen;
        const auto load = [&](int i, int component) {
          seen.push_back(b.emit(Op::array_load, {at(i)}, 0, component));
        };
        b.emit_void(Op::array_store, {at(0), b.const_f32(5)}, 0, 0);
        b.emit_void(Op::array_store, {at(0), b.const_f32(6)}, 0, 1);
        b.emit_void(Op::array_store, {at(3), b.const_f32(7)}, 0, 0);   // at capacity: nothing
        b.emit_void(Op::array_store, {at(-1), b.const_f32(8)}, 0, 0);  // before the start: nothing
        b.emit_void(Op::array_store, {at(2), b.const_f32(9)}, 0,
                    0);  // within capacity, past the length
        load(0, 0), load(0, 1), load(2, 0), load(-1, 0), load(3, 0);  // 5 6 0 0 0
        b.emit_void(Op::array_resize, {at(3)}, 0);
        load(2, 0);                                                          // 0: a new element
        seen.push_back(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 0)}));  // 3
        b.emit_void(Op::array_store, {at(2), b.const_f32(9)}, 0, 0);
        load(2, 0);  // 9
        b.emit_void(Op::array_resize, {at(-5)}, 0);
        load(0, 0);                                                          // 0
        seen.push_back(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 0)}));  // 0
        b.emit_void(Op::array_resize, {at(99)}, 0);
        load(2, 0);  // 0 again, though 9 was there
        seen.push_back(b.emit(Op::i2f, {b.emit(Op::array_length, {}, 0)}));  // 3, the capacity
        return seen;
      },
      {{.name = "a", .components = 2, .capacity = 3, .initial_length = 1}});
  const std::vector<float> expected = {5, 6, 0, 0, 0, 0, 3, 9, 0, 0, 0, 3};
  ASSERT_EQ(result.results.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(to_f32(result.results[i]), expected[i]) << i;
}

TEST(Interpreter, ACheckThatFailsEndsTheRun) {
  const auto fails = run([](Builder& b) {
    b.emit_void(Op::check, {b.const_bool(true)}, 0);
    b.emit_void(Op::check, {b.const_bool(false)}, 1);
    b.emit_void(Op::check, {b.const_bool(false)}, 0);
    return std::vector<Value>{};
  });
  EXPECT_EQ(fails.outcome.end, End::failed_check);
  EXPECT_EQ(fails.outcome.check, 1);
}

// sum and count of 1, 2, ... n by a loop with two carried values
std::vector<Value> emit_sum(Builder& b, int n) {
  Region head, body;
  const Value limit = b.const_i32(n);
  const std::vector<Value> initial = {b.const_i32(0), b.const_i32(0)};
  b.begin_region(head);
  const Value i = b.add_param(head, Type::i32);
  b.add_param(head, Type::i32);
  head.yields = {b.emit(Op::ilt, {i, limit})};
  b.end_region();
  b.begin_region(body);
  const Value j = b.add_param(body, Type::i32);
  const Value sum = b.add_param(body, Type::i32);
  const Value next = b.emit(Op::iadd, {j, b.const_i32(1)});
  body.yields = {next, b.emit(Op::iadd, {sum, next})};
  b.end_region();
  return b.emit_loop(initial, std::move(head), std::move(body));
}

TEST(Interpreter, LoopsCarryValuesSideBySide) {
  EXPECT_EQ(run([](Builder& b) { return emit_sum(b, 10); }).results, (std::vector<Bits>{10, 55}));
  EXPECT_EQ(run([](Builder& b) { return emit_sum(b, 0); }).results, (std::vector<Bits>{0, 0}));
}

TEST(Interpreter, LoopsThatExchangeTheirValuesSeeThoseOfTheTurnBefore) {
  const auto result = run([](Builder& b) {
    Region head, body;
    const std::vector<Value> initial = {b.const_i32(0), b.const_i32(11), b.const_i32(22)};
    const Value limit = b.const_i32(3);
    b.begin_region(head);
    const Value i = b.add_param(head, Type::i32);
    b.add_param(head, Type::i32), b.add_param(head, Type::i32);
    head.yields = {b.emit(Op::ilt, {i, limit})};
    b.end_region();
    b.begin_region(body);
    const Value j = b.add_param(body, Type::i32);
    const Value left = b.add_param(body, Type::i32), right = b.add_param(body, Type::i32);
    body.yields = {b.emit(Op::iadd, {j, b.const_i32(1)}), right, left};
    b.end_region();
    return b.emit_loop(initial, std::move(head), std::move(body));
  });
  EXPECT_EQ(result.results, (std::vector<Bits>{3, 22, 11}));
}

TEST(Interpreter, StopsWhenToldAndWhenTurnsRunOut) {
  const auto write = [](Builder& b) { return emit_sum(b, 10); };
  EXPECT_EQ(run(write, {}, 10).outcome.end, End::finished);
  EXPECT_EQ(run(write, {}, 9).outcome.end, End::out_of_turns);

  Module module = module_with_tables();
  Builder b(module, module.main());
  module.main().body.yields = emit_sum(b, high);
  const std::atomic<bool> cancel = true;
  std::vector<Bits> results(2);
  const Environment environment{.cancel = &cancel};
  EXPECT_EQ(Interpreter(module).run(0, {}, environment, results).end, End::cancelled);
}

TEST(Interpreter, CallsGiveEachCallItsOwnValues) {
  Module module;
  module.functions.resize(2);
  module.entry = 1;
  Builder callee(module, module.functions[0]);
  const Value p = callee.add_param(module.functions[0].body, Type::f32);
  const Value q = callee.add_param(module.functions[0].body, Type::f32);
  module.functions[0].body.yields = {callee.emit(Op::fsub, {p, q}), callee.emit(Op::fadd, {p, q})};
  Builder b(module, module.functions[1]);
  const Type types[] = {Type::f32, Type::f32};
  const auto first = b.emit_multi(Op::call, std::vector{b.const_f32(5), b.const_f32(3)}, types, 0);
  const auto second = b.emit_multi(Op::call, std::vector{first[1], first[0]}, types, 0);
  module.functions[1].body.yields = {first[0], first[1], second[0], second[1]};
  EXPECT_EQ(interpret(module, 1, {}).results,
            (std::vector<Bits>{to_bits(2.0f), to_bits(8.0f), to_bits(6.0f), to_bits(10.0f)}));
}

}  // namespace
}  // namespace pse::ir
