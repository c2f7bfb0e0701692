// Every builtin on numbers and every noise: the compiled kernel gives the interpreter's bits, on
// each processor level.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "codegen/kernel.h"
#include "codegen/target.h"
#include "lower/builtins.h"

namespace pse {
namespace {

constexpr int inputs = 5;

// A program that calls all builtins of a group on its inputs and puts out all components.
ir::Module calls_of(const std::string& group) {
  ir::Module module;
  module.functions.reserve(1 + BuiltinEmitter::room_for_builtins);
  ir::Builder builder(module, module.functions.emplace_back());
  module.functions[0].name = "main";
  Components in;
  for (int i = 0; i < inputs; ++i) {
    module.inputs.push_back({"in" + std::to_string(i), ir::Rate::sample});
    in.push_back(builder.emit(ir::Op::input, {}, i));
  }
  BuiltinEmitter emitter(module);
  const auto put = [&](const BuiltinCall& call) {
    const auto result = emitter.emit(builder, call);
    if (!result) return false;
    for (const ir::Value value : *result) {
      module.main().body.yields.push_back(value);
      module.outputs.push_back({std::string(call.name)});
    }
    return true;
  };
  for (const Builtin& builtin : builtins()) {
    if (builtin.group != group || !builtin.same_as.empty()) continue;
    bool called = false;
    if (builtin.result == ResultShape::elementwise) {
      // As many numbers as it takes.
      for (std::size_t n = 1; n <= 3 && !called; ++n) {
        std::vector<Components> arguments;
        for (std::size_t k = 0; k < n; ++k) arguments.push_back({in[k]});
        called = put({builtin.name, arguments, {}});
      }
    } else {
      const Components point(in.begin(), in.begin() + 3);
      called = put({builtin.name, {point}, {}}) ||
               put({builtin.name, {point, {in[3]}}, {{"seed", {in[4]}}}});
      put({builtin.name, {point}, {{"period", {in[3]}}, {"seed", {in[4]}}}});
    }
    EXPECT_TRUE(called) << builtin.name;
  }
  return module;
}

std::vector<std::vector<float>> columns(std::int64_t count) {
  std::mt19937 random(5);
  std::vector<std::vector<float>> result(
      inputs, std::vector<float>(static_cast<std::size_t>((count + 15) / 16 * 16)));
  for (auto& column : result) {
    for (float& x : column) {
      x = std::ldexp(static_cast<float>(random()) * 0x1p-31f - 1.0f,
                     static_cast<int>(random() % 12) - 2);
      if (random() % 4 == 0) x = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    }
  }
  return result;
}

void agree(const std::string& group) {
  constexpr std::int64_t count = 203;
  const auto split =
      std::make_shared<const passes::SplitModule>(passes::run_pipeline(calls_of(group)));
  const ir::Module& module = split->module;
  const auto run = [&](const Kernel& kernel) {
    FrameState state;
    RunStatus status;
    Scratch scratch;
    state.uniforms.resize(module.inputs.size());
    kernel.run_frame(state, status);
    const auto in = columns(count);
    std::vector<std::vector<float>> out(module.outputs.size(), std::vector<float>(in[0].size()));
    std::vector<const float*> in_pointers(module.inputs.size());
    std::vector<float*> out_pointers;
    for (std::size_t i = 0; i < inputs; ++i) in_pointers[i] = in[i].data();
    for (auto& column : out) out_pointers.push_back(column.data());
    kernel.run_samples(state, status, scratch, in_pointers.data(), out_pointers.data(), count);
    return out;
  };
  const auto expected = run(*make_interpreted_kernel(split));

  for (const Target& target : targets) {
    if (!host_target() || &target > host_target()) continue;
    CodegenOptions options;
    options.cpu = std::string(target.name);
    const auto kernel = compile_kernel(*split, options);
    ASSERT_TRUE(kernel) << kernel.error();
    const auto found = run(**kernel);
    for (std::size_t o = 0; o < found.size(); ++o) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(expected[o][i]),
                  std::bit_cast<std::uint32_t>(found[o][i]))
            << module.outputs[o].name << ", sample " << i << " on " << target.name;
      }
    }
  }
}

TEST(Agree, MathBuiltins) { agree("math"); }
TEST(Agree, NoiseBuiltins) { agree("noise"); }

}  // namespace
}  // namespace pse
