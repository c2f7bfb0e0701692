// if and loop: uniform and varying conditions, nesting, results kept by samples that have finished,
// cancellation.
#include <atomic>
#include <chrono>
#include <thread>

#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

class Control : public OnEveryMachine {};

std::vector<float> counting(int n, float start = 0, float step = 1) {
  std::vector<float> result;
  for (int i = 0; i < n; ++i) result.push_back(start + step * static_cast<float>(i));
  return result;
}

// x < limit ? 2x : x - 1, by if; `rate` decides whether the condition varies.
void emit_choice(TestProgram& program, ir::Rate rate) {
  ir::Builder& b = program.build;
  const ir::Value x = program.input(rate), limit = program.input(rate);
  ir::Region then_region, else_region;
  b.begin_region(then_region);
  then_region.yields = {b.emit(Op::fmul, {x, b.const_f32(2)})};
  b.end_region();
  b.begin_region(else_region);
  else_region.yields = {b.emit(Op::fsub, {x, b.const_f32(1)})};
  b.end_region();
  const ir::Value condition = b.emit(Op::flt, {x, limit});
  program.output(b.emit_if(condition, std::move(then_region), std::move(else_region))[0]);
  program.finish();
}

TEST_P(Control, IfChoosesForEachSample) {
  TestProgram program;
  emit_choice(program, ir::Rate::sample);
  const Columns out = run(program, GetParam(), {counting(37), std::vector<float>(37, 20.0f)}, 37);
  for (int i = 0; i < 37; ++i) {
    const auto x = static_cast<float>(i);
    EXPECT_EQ(out[0][i], i < 20 ? 2 * x : x - 1);
  }
}

TEST_P(Control, UniformIfBranches) {
  TestProgram program;
  emit_choice(program, ir::Rate::frame);
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  for (const float x : {1.0f, 5.0f}) {
    Runner once;
    EXPECT_EQ(once(*kernel, program.split.module, {x, 3.0f}, {}, 5)[0][4], x < 3 ? 2 * x : x - 1);
  }
}

// How often x can be halved before it falls below 1, and what is left; each sample turns as often
// as it needs.
void emit_halving(TestProgram& program) {
  ir::Builder& b = program.build;
  const ir::Value x = program.input();
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value h = b.add_param(head, ir::Type::f32);
  b.add_param(head, ir::Type::i32);
  head.yields = {b.emit(Op::fle, {b.const_f32(1), h})};
  b.end_region();
  b.begin_region(body);
  const ir::Value v = b.add_param(body, ir::Type::f32), n = b.add_param(body, ir::Type::i32);
  body.yields = {b.emit(Op::fmul, {v, b.const_f32(0.5f)}), b.emit(Op::iadd, {n, b.const_i32(1)})};
  b.end_region();
  const ir::Value initial[] = {x, b.const_i32(0)};
  const auto results = b.emit_loop(initial, std::move(head), std::move(body));
  program.output(results[0]);
  program.output(b.emit(Op::i2f, {results[1]}));
  program.finish();
}

TEST_P(Control, VaryingLoopKeepsWhatEachSampleLeftWith) {
  TestProgram program;
  emit_halving(program);
  const std::vector<float> x = {1,     0.5f, 2, 3, 1024, 0, -5, from_bits(nan_bits), 7, 8, 0x1p100f,
                                0.75f, 1,    1, 1, 4095, 6, 2};
  const std::vector<float> left = {0.5f, 0.5f, 0.5f,   0.75f,          0.5f,  0,
                                   -5,   0,    0.875f, 0.5f,           0.5f,  0.75f,
                                   0.5f, 0.5f, 0.5f,   4095.0f / 4096, 0.75f, 0.5f};
  const std::vector<float> turns = {1, 0, 2, 2, 11, 0, 0, 0, 3, 4, 101, 0, 1, 1, 1, 12, 3, 2};
  const Columns out = run(program, GetParam(), {x}, 18);
  for (std::size_t i = 0; i < 18; ++i) {
    if (i == 7)
      EXPECT_EQ(bits(out[0][i]), nan_bits);
    else
      EXPECT_EQ(out[0][i], left[i]) << i;
    EXPECT_EQ(out[1][i], turns[i]) << i;
  }
}

// sum over i < rows(sample) of sum over j <= i of (j if the sample is odd, else 1): a varying if in
// two varying loops.
TEST_P(Control, NestedVaryingLoopsAndIf) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value rows = b.emit(Op::f2i, {program.input()});
  const ir::Value odd = b.emit(Op::ieq, {b.emit(Op::iand, {rows, b.const_i32(1)}), b.const_i32(1)});
  const ir::Value initial[] = {b.const_i32(0), b.const_i32(0)};
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value i0 = b.add_param(head, ir::Type::i32);
  b.add_param(head, ir::Type::i32);
  head.yields = {b.emit(Op::ilt, {i0, rows})};
  b.end_region();
  b.begin_region(body);
  const ir::Value i = b.add_param(body, ir::Type::i32), sum = b.add_param(body, ir::Type::i32);
  {
    ir::Region inner_head, inner_body;
    b.begin_region(inner_head);
    const ir::Value j0 = b.add_param(inner_head, ir::Type::i32);
    b.add_param(inner_head, ir::Type::i32);
    inner_head.yields = {b.emit(Op::ile, {j0, i})};
    b.end_region();
    b.begin_region(inner_body);
    const ir::Value j = b.add_param(inner_body, ir::Type::i32),
                    s = b.add_param(inner_body, ir::Type::i32);
    ir::Region yes, no;
    b.begin_region(yes);
    yes.yields = {b.emit(Op::iadd, {s, j})};
    b.end_region();
    b.begin_region(no);
    no.yields = {b.emit(Op::iadd, {s, b.const_i32(1)})};
    b.end_region();
    const ir::Value next = b.emit_if(odd, std::move(yes), std::move(no))[0];
    inner_body.yields = {b.emit(Op::iadd, {j, b.const_i32(1)}), next};
    b.end_region();
    const ir::Value start[] = {b.const_i32(0), sum};
    const auto inner = b.emit_loop(start, std::move(inner_head), std::move(inner_body));
    body.yields = {b.emit(Op::iadd, {i, b.const_i32(1)}), inner[1]};
  }
  b.end_region();
  const auto results = b.emit_loop(initial, std::move(head), std::move(body));
  program.output(b.emit(Op::i2f, {results[1]}));
  program.output(b.emit(Op::i2f, {results[0]}));
  program.finish();
  const Columns out = run(program, GetParam(), {counting(21)}, 21);
  for (int n = 0; n < 21; ++n) {
    int expected = 0;
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j <= k; ++j) expected += n % 2 == 1 ? j : 1;
    }
    EXPECT_EQ(out[0][n], static_cast<float>(expected)) << n;
    EXPECT_EQ(out[1][n], static_cast<float>(n)) << n;
  }
}

// A boolean carried round a loop flips once a turn.
TEST_P(Control, BooleansCarriedRoundALoop) {
  TestProgram program;
  ir::Builder& b = program.build;
  const ir::Value limit = program.input();
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value i0 = b.add_param(head, ir::Type::f32);
  b.add_param(head, ir::Type::boolean);
  head.yields = {b.emit(Op::flt, {i0, limit})};
  b.end_region();
  b.begin_region(body);
  const ir::Value i = b.add_param(body, ir::Type::f32), flag = b.add_param(body, ir::Type::boolean);
  body.yields = {b.emit(Op::fadd, {i, b.const_f32(1)}), b.emit(Op::bnot, {flag})};
  b.end_region();
  const ir::Value initial[] = {b.const_f32(0), b.const_bool(true)};
  program.output_bool(b.emit_loop(initial, std::move(head), std::move(body))[1]);
  program.finish();
  const Columns out = run(program, GetParam(), {counting(19)}, 19);
  for (int n = 0; n < 19; ++n) EXPECT_EQ(out[0][n], n % 2 == 0 ? 1.0f : 0.0f);
}

TEST_P(Control, EveryTailLengthGivesTheSameSamples) {
  TestProgram program;
  emit_halving(program);
  const std::vector<float> x = counting(70, 0.25f, 1.75f);
  const Columns all = run(program, GetParam(), {x}, 70);
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  for (int count = 0; count <= 40; ++count) {
    Runner once;
    const Columns some =
        once(*kernel, program.split.module, {0}, {{x.begin(), x.begin() + count}}, count);
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(some[0][i], all[0][i]);
      EXPECT_EQ(some[1][i], all[1][i]);
    }
  }
}

void emit_endless(TestProgram& program, ir::Rate rate) {
  ir::Builder& b = program.build;
  const ir::Value x = program.input(rate);
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value h = b.add_param(head, ir::Type::f32);
  head.yields = {b.emit(Op::flt, {h, b.const_f32(2)})};
  b.end_region();
  b.begin_region(body);
  body.yields = {b.emit(Op::fmin, {b.add_param(body, ir::Type::f32), b.const_f32(1)})};
  b.end_region();
  program.output(b.emit_loop({{x}}, std::move(head), std::move(body))[0]);
  program.finish();
}

TEST_P(Control, AnEndlessLoopEndsWhenCancelled) {
  for (const ir::Rate rate : {ir::Rate::sample, ir::Rate::frame}) {
    TestProgram program;
    emit_endless(program, rate);
    const auto kernel = compile(program, GetParam());
    ASSERT_TRUE(kernel);
    Runner once;
    std::thread canceller([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      once.status.cancel = true;
    });
    once(*kernel, program.split.module, {0}, {{0, 0, 0}}, 3);
    canceller.join();
    EXPECT_EQ(once.status.failed_check, -1);
  }
}

// A called function whose varying loop must stop for lanes that never entered the call's branch.
TEST_P(Control, CallsRunUnderTheirCallersMask) {
  TestProgram program;
  ir::Module& module = program.split.module;
  module.functions.emplace_back();
  module.functions[2].name = "count_up";
  {
    // while v < 100: v = v * v; endless for v in [0, 1]
    ir::Function& function = module.functions[2];
    ir::Builder b(module, function);
    const ir::Value x = b.add_param(function.body, ir::Type::f32),
                    step = b.add_param(function.body, ir::Type::f32);
    ir::Region head, body;
    b.begin_region(head);
    const ir::Value h = b.add_param(head, ir::Type::f32);
    head.yields = {b.emit(Op::flt, {h, b.const_f32(100)})};
    b.end_region();
    b.begin_region(body);
    const ir::Value v = b.add_param(body, ir::Type::f32);
    body.yields = {b.emit(Op::fmul, {v, v})};
    b.end_region();
    const ir::Value end = b.emit_loop({{x}}, std::move(head), std::move(body))[0];
    function.body.yields = {end, b.emit(Op::fadd, {end, step}),
                            b.emit(Op::flt, {x, b.const_f32(3)})};
  }
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), uniform = program.input(ir::Rate::frame);
  ir::Region yes, no;
  const ir::Type types[] = {ir::Type::f32, ir::Type::f32, ir::Type::boolean};
  b.begin_region(yes);
  const ir::Value arguments[] = {x, uniform};
  const auto called = b.emit_multi(Op::call, arguments, types, 2);
  yes.yields = {called[0], called[1], called[2]};
  b.end_region();
  b.begin_region(no);
  no.yields = {b.const_f32(-1), b.const_f32(-2), b.const_bool(false)};
  b.end_region();
  const auto results =
      b.emit_if(b.emit(Op::flt, {b.const_f32(1), x}), std::move(yes), std::move(no));
  program.output(results[0]);
  program.output(results[1]);
  program.output_bool(results[2]);
  // The same function for values that are the same for all samples.
  const ir::Value both[] = {uniform, uniform};
  program.output(b.emit_multi(Op::call, both, types, 2)[1]);
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  Runner once;
  const Columns out = once(*kernel, module, {0, 10}, {{2, 0.5f, 3, 1, 200, 0, 0, 0, 0, 0, 4}}, 11);
  EXPECT_EQ(out[0], (std::vector<float>{256, -1, 6561, -1, 200, -1, -1, -1, -1, -1, 256}));
  EXPECT_EQ(out[1], (std::vector<float>{266, -2, 6571, -2, 210, -2, -2, -2, -2, -2, 266}));
  EXPECT_EQ(out[2], (std::vector<float>{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(out[3], std::vector<float>(11, 110.0f));
}

INSTANTIATE_TEST_SUITE_P(All, Control, ::testing::ValuesIn(all_machines()), machine_name);

}  // namespace
}  // namespace pse::testing_support
