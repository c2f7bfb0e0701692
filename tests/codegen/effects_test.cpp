// Checks and functions of the host.
#include <set>

#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

class Effect : public OnEveryMachine {};

std::vector<float> counting(int n) {
  std::vector<float> result;
  for (int i = 0; i < n; ++i) result.push_back(static_cast<float>(i));
  return result;
}

// Check 1 fails where x is not below the limit; inside an if that only samples from 5 on enter.
void emit_checked(TestProgram& program) {
  ir::Builder& b = program.build;
  program.split.module.checks = {{{}, "zero"}, {{}, "one"}};
  const ir::Value x = program.input(), limit = program.input(ir::Rate::frame);
  b.emit_void(Op::check, {b.emit(Op::fle, {b.const_f32(0), x})}, 0);
  ir::Region yes, no;
  b.begin_region(yes);
  b.emit_void(Op::check, {b.emit(Op::flt, {x, limit})}, 1);
  b.end_region();
  b.emit_if(b.emit(Op::fle, {b.const_f32(5), x}), std::move(yes), std::move(no));
  program.output(x);
  program.finish();
}

TEST_P(Effect, ChecksReportTheFirstSampleThatFails) {
  TestProgram program;
  emit_checked(program);
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  for (const int limit : {0, 5, 6, 17, 31, 33, 36}) {
    Runner once;
    once(*kernel, program.split.module, {0, static_cast<float>(limit)}, {counting(37)}, 37);
    EXPECT_EQ(once.status.failed_check, 1);
    EXPECT_EQ(once.status.failed_sample, static_cast<unsigned>(limit < 5 ? 5 : limit)) << limit;
  }
  Runner once;
  once(*kernel, program.split.module, {0, 37}, {counting(37)}, 37);
  EXPECT_EQ(once.status.failed_check, -1);
  EXPECT_FALSE(once.status.cancel);
}

TEST_P(Effect, TheFirstReportStays) {
  TestProgram program;
  emit_checked(program);
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  Runner once;
  once.status.failed_check = 0;
  once.status.failed_sample = 99;
  once(*kernel, program.split.module, {0, 7}, {counting(37)}, 37);
  EXPECT_EQ(once.status.failed_check, 0);
  EXPECT_EQ(once.status.failed_sample, 99u);
}

// In uniform control with a uniform condition: fails for the whole vector at its first sample.
TEST_P(Effect, AUniformCheckFailsAtSampleZero) {
  TestProgram program;
  ir::Builder& b = program.build;
  program.split.module.checks = {{{}, "zero"}};
  b.emit_void(Op::check, {b.emit(Op::feq, {program.input(ir::Rate::frame), b.const_f32(1)})}, 0);
  program.output(b.const_f32(3));
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  Runner bad, good;
  bad(*kernel, program.split.module, {2}, {}, 20);
  EXPECT_EQ(bad.status.failed_check, 0);
  EXPECT_EQ(bad.status.failed_sample, 0u);
  EXPECT_EQ(good(*kernel, program.split.module, {1}, {}, 20)[0], std::vector<float>(20, 3.0f));
}

struct Counter {
  std::int64_t samples = 0;
  float offset = 1000;
};

// (a, b) -> (a - b, 2 a, offset)
void host(void* user, std::int64_t count, const float* const* arguments, float* const* results) {
  auto* counter = static_cast<Counter*>(user);
  counter->samples += count;
  for (std::int64_t i = 0; i < count; ++i) {
    results[0][i] = arguments[0][i] - arguments[1][i];
    results[1][i] = 2 * arguments[0][i];
    results[2][i] = counter->offset;
  }
}

TEST_P(Effect, ExternalsTakeAndGiveWholeVectors) {
  TestProgram program;
  ir::Module& module = program.split.module;
  module.externals = {{"unused", 0, 0}, {"host", 2, 3}};
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), k = program.input(ir::Rate::frame);
  const ir::Type types[] = {ir::Type::f32, ir::Type::f32, ir::Type::f32};
  const ir::Value arguments[] = {x, k}, same[] = {k, k};
  for (const ir::Value value : b.emit_multi(Op::external, arguments, types, 1))
    program.output(value);
  program.output(b.emit_multi(Op::external, same, types, 1)[1]);
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  Counter counter;
  Runner once;
  once.state.externals = {{}, {&host, &counter}};
  const Columns out = once(*kernel, module, {0, 3}, {counting(23)}, 23);
  for (int s = 0; s < 23; ++s) {
    EXPECT_EQ(out[0][s], static_cast<float>(s) - 3);
    EXPECT_EQ(out[1][s], 2.0f * static_cast<float>(s));
    EXPECT_EQ(out[2][s], 1000.0f);
    EXPECT_EQ(out[3][s], 6.0f);
  }
  EXPECT_GE(counter.samples, 23);
}

// In a branch that only every third sample takes, the host is asked for these alone.
void host_in_branch(void* user, std::int64_t count, const float* const* arguments,
                    float* const* results) {
  auto* asked = static_cast<std::vector<float>*>(user);
  for (std::int64_t i = 0; i < count; ++i) {
    asked->push_back(arguments[0][i]);
    results[0][i] = 10 * arguments[0][i];
  }
}

TEST_P(Effect, ExternalsAreAskedForActiveSamplesOnly) {
  TestProgram program;
  ir::Module& module = program.split.module;
  module.externals = {{"host", 1, 1}};
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), taken = program.input();
  const ir::Type types[] = {ir::Type::f32};
  const ir::Value condition = b.emit(Op::flt, {b.const_f32(0.5f), taken});
  ir::Region then_region, else_region;
  b.begin_region(then_region);
  const ir::Value arguments[] = {x};
  then_region.yields = b.emit_multi(Op::external, arguments, types, 0);
  b.end_region();
  else_region.yields = {x};
  program.output(b.emit_if(condition, std::move(then_region), std::move(else_region))[0]);
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  std::vector<float> asked, third(24);
  for (std::size_t s = 0; s < third.size(); s += 3) third[s] = 1;
  Runner once;
  once.state.externals = {{&host_in_branch, &asked}};
  const Columns out = once(*kernel, module, {0, 0}, {counting(24), third}, 24);
  for (int s = 0; s < 24; ++s)
    EXPECT_EQ(out[0][s], s % 3 == 0 ? 10.0f * static_cast<float>(s) : static_cast<float>(s)) << s;
  // The last vector repeats its last sample, which is not taken.
  EXPECT_EQ(asked, (std::vector<float>{0, 3, 6, 9, 12, 15, 18, 21}));
}

// One without results is told of just the active samples, in a loop and an if as well.
TEST_P(Effect, ExternalsMayOnlyBeTold) {
  TestProgram program;
  ir::Module& module = program.split.module;
  module.externals = {{"told", 1, 0}};
  ir::Builder& b = program.build;
  const ir::Value x = program.input(), limit = program.input(ir::Rate::frame);
  ir::Region head, body, yes, no;
  const ir::Value start = b.const_f32(0);
  const ir::Value at_head = b.add_param(head, ir::Type::f32);
  b.begin_region(head);
  head.yields = {b.emit(Op::flt, {at_head, x})};
  b.end_region();
  const ir::Value turn = b.add_param(body, ir::Type::f32);
  b.begin_region(body);
  b.begin_region(no);
  b.emit_multi(Op::external, {{x}}, {}, 0);
  b.end_region();
  b.emit_if(b.emit(Op::flt, {turn, limit}), std::move(yes), std::move(no));
  body.yields = {b.emit(Op::fadd, {turn, b.const_f32(1)})};
  b.end_region();
  program.output(b.emit_loop({&start, 1}, std::move(head), std::move(body))[0]);
  program.finish();
  const auto kernel = compile(program, GetParam());
  ASSERT_TRUE(kernel);
  std::set<float> told;
  const auto tell = [](void* user, std::int64_t count, const float* const* arguments,
                       float* const*) {
    static_cast<std::set<float>*>(user)->insert(arguments[0], arguments[0] + count);
  };
  Runner once;
  once.state.externals = {{tell, &told}};
  const Columns out = once(*kernel, module, {0, 16}, {counting(21)}, 21);
  for (int s = 0; s < 21; ++s) EXPECT_EQ(out[0][s], static_cast<float>(s));
  EXPECT_EQ(told, (std::set<float>{17, 18, 19, 20}));
}

INSTANTIATE_TEST_SUITE_P(All, Effect, ::testing::ValuesIn(all_machines()), machine_name);

}  // namespace
}  // namespace pse::testing_support
