// The frame function is interpreted while it is short, and compiled when it is not: the same
// numbers, and the slots and arrays of an abandoned attempt leave no trace.
#include "kernel_fixture.h"

namespace pse::testing_support {
namespace {

using ir::Op;

// Slot 0: a sum of 1/k over k = 1 .. `turns`, a knob. Each turn also appends to an array.
void emit_harmonic(TestProgram& program) {
  ir::Module& module = program.split.module;
  for (ir::Function& function : module.functions)
    function.arrays.push_back({"a", 1, 8, ir::Rate::frame, 0});
  program.output(program.input());
  program.input(ir::Rate::frame);
  program.finish();
  module.inputs.push_back({"$slot.0", ir::Rate::frame});

  ir::Function& frame = module.functions[1];
  ir::Builder b(module, frame);
  const ir::Value turns = b.emit(Op::f2i, {b.emit(Op::input, {}, 1)});
  ir::Region head, body;
  b.begin_region(head);
  const ir::Value h = b.add_param(head, ir::Type::i32);
  b.add_param(head, ir::Type::f32);
  head.yields = {b.emit(Op::ilt, {h, turns})};
  b.end_region();
  b.begin_region(body);
  const ir::Value k = b.add_param(body, ir::Type::i32), sum = b.add_param(body, ir::Type::f32);
  const ir::Value next = b.emit(Op::iadd, {k, b.const_i32(1)});
  const ir::Value term = b.emit(Op::fdiv, {b.const_f32(1), b.emit(Op::i2f, {next})});
  const ir::Value length = b.emit(Op::array_length, {}, 0);
  b.emit_void(Op::array_resize, {b.emit(Op::iadd, {length, b.const_i32(1)})}, 0);
  b.emit_void(Op::array_store, {length, term}, 0, 0);
  body.yields = {next, b.emit(Op::fadd, {sum, term})};
  b.end_region();
  const ir::Value initial[] = {b.const_i32(0), b.const_f32(0)};
  frame.body.yields = {b.emit_loop(initial, std::move(head), std::move(body))[1]};
}

float harmonic(int turns) {
  float sum = 0;
  for (int k = 1; k <= turns; ++k) sum += 1.0f / static_cast<float>(k);
  return sum;
}

TEST(Frame, ShortAndLongFramesAreTheSame) {
  TestProgram program;
  emit_harmonic(program);
  const Machine machine{4, all_machines().front().cpu};
  for (const bool at_once : {false, true}) {
    const auto kernel = compile(program, machine, true, at_once);
    ASSERT_TRUE(kernel);
    // The long one turns interpreting off; what is short afterwards runs compiled.
    for (const int turns : {0, 3, 100, 3'000'000, 8}) {
      Runner once;
      once(*kernel, program.split.module, {0, static_cast<float>(turns), 0}, {{0, 0, 0}}, 3);
      EXPECT_EQ(once.state.uniforms[2], harmonic(turns)) << turns;
      EXPECT_EQ(once.state.array_lengths[0], std::min(turns, 8)) << turns;
      EXPECT_EQ(once.state.arrays[0], turns > 0 ? 1.0f : 0.0f) << turns;
    }
  }
}

}  // namespace
}  // namespace pse::testing_support
