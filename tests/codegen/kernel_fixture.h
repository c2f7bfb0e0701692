// What the tests of compiled kernels share: a module under construction, and running it at every
// width and on every processor level that this machine has.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "codegen/kernel.h"
#include "codegen/target.h"
#include "ir/builder.h"

namespace pse::testing_support {

inline std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }
inline float from_bits(std::uint32_t value) { return std::bit_cast<float>(value); }
inline constexpr std::uint32_t nan_bits = 0x7fc00000u;

// A program under construction: functions[0] runs per sample, functions[1] per frame.
struct TestProgram {
  passes::SplitModule split;
  ir::Builder build;

  TestProgram() : build{prepare(split), split.module.functions[0]} {}
  TestProgram(const TestProgram&) = delete;
  TestProgram& operator=(const TestProgram&) = delete;

  static ir::Module& prepare(passes::SplitModule& split) {
    split.module.functions.resize(2);
    split.module.functions.reserve(16);  // builders keep references
    split.module.functions[0].name = "main";
    split.module.functions[1].name = "frame";
    split.frame = 1;
    return split.module;
  }

  ir::Value input(ir::Rate rate = ir::Rate::sample) {
    split.module.inputs.push_back({"in" + std::to_string(split.module.inputs.size()), rate});
    return build.emit(ir::Op::input, {}, static_cast<std::int32_t>(split.module.inputs.size() - 1));
  }
  void output(ir::Value value) {
    split.module.outputs.push_back({"out" + std::to_string(split.module.outputs.size())});
    split.module.functions[0].body.yields.push_back(value);
  }
  // A 32-bit integer from two inputs, its upper and lower half; and back: no NaN is ever carried as
  // bits.
  ir::Value input_int(ir::Rate rate) {
    const ir::Value high = build.emit(ir::Op::f2i, {input(rate)}),
                    low = build.emit(ir::Op::f2i, {input(rate)});
    return build.emit(ir::Op::ior, {build.emit(ir::Op::ishl, {high, build.const_i32(16)}), low});
  }
  void output_int(ir::Value value) {
    const ir::Value high = build.emit(ir::Op::ishr, {value, build.const_i32(16)});
    const ir::Value low = build.emit(ir::Op::iand, {value, build.const_i32(0xffff)});
    output(build.emit(ir::Op::i2f, {high}));
    output(build.emit(ir::Op::i2f, {low}));
  }
  void output_bool(ir::Value value) {
    output(build.emit(ir::Op::select, {value, build.const_f32(1), build.const_f32(0)}));
  }
  // A loop of `turns` turns that carries numbers, beginning with `start`; `turn` makes the next
  // ones of them. The result is what the last turn leaves.
  using Carried = std::vector<ir::Value>;
  Carried counted_loop(ir::Value turns, const Carried& start,
                       const std::function<Carried(const Carried&)>& turn) {
    const auto with_count = [](ir::Value count, Carried values) {
      values.insert(values.begin(), count);
      return values;
    };
    const auto params = [&](ir::Region& region, ir::Value& count) {
      count = build.add_param(region, ir::Type::i32);
      Carried values;
      for (std::size_t i = 0; i < start.size(); ++i)
        values.push_back(build.add_param(region, ir::Type::f32));
      return values;
    };
    ir::Region head, body;
    ir::Value count = ir::no_value;
    build.begin_region(head);
    params(head, count);
    head.yields = {build.emit(ir::Op::ilt, {count, turns})};
    build.end_region();
    build.begin_region(body);
    const Carried now = params(body, count);
    const Carried next = turn(now);
    body.yields = with_count(build.emit(ir::Op::iadd, {count, build.const_i32(1)}), next);
    build.end_region();
    const Carried all = build.emit_loop(with_count(build.const_i32(0), start), std::move(head),
                                        std::move(body));
    return {all.begin() + 1, all.end()};
  }
  void finish() { split.first_slot = static_cast<std::uint32_t>(split.module.inputs.size()); }
};

struct Machine {
  int width;
  std::string cpu;
};
inline void PrintTo(const Machine& machine, std::ostream* out) {
  *out << machine.cpu << " x" << machine.width;
}

// In the place of a processor level: the first tier's kernel.
inline constexpr const char* first_tier = "first_tier";

// Every width on every level that this processor has, and the first tier if it has that.
inline std::vector<Machine> all_machines() {
  std::vector<Machine> result;
  for (const Target& target : targets) {
    if (!host_target() || &target > host_target()) continue;
    for (const int width : {1, 4, 8, 16, 32}) result.push_back({width, std::string(target.name)});
  }
  if (host_target() && host_target()->avx2) result.push_back({8, first_tier});
  return result;
}

using Columns = std::vector<std::vector<float>>;

inline std::unique_ptr<Kernel> compile(const TestProgram& program, const Machine& machine,
                                       bool optimize = true, bool compile_frame = true) {
  CodegenOptions options;
  options.width = machine.width;
  options.cpu = machine.cpu;
  options.optimize = optimize;
  options.compile_frame = compile_frame;
  const bool first = machine.cpu == first_tier;
  if (first) options.cpu.clear();
  auto kernel = first ? make_first_kernel(program.split, options)
                      : compile_kernel(program.split, options);
  if (!kernel) {
    ADD_FAILURE() << kernel.error();
    return nullptr;
  }
  return std::move(*kernel);
}

struct Runner {
  FrameState state;
  RunStatus status;
  Scratch scratch;

  // Runs a frame and its samples. Uniform inputs are taken from `uniforms`, the others from
  // `columns`.
  Columns operator()(const Kernel& kernel, const ir::Module& module,
                     const std::vector<float>& uniforms, const Columns& columns,
                     std::int64_t count) {
    state.uniforms = uniforms;
    kernel.run_frame(state, status);
    const auto padded = static_cast<std::size_t>((count + 15) / 16 * 16);
    Columns in = columns, out(module.outputs.size(), std::vector<float>(padded, -99.0f));
    std::vector<const float*> inputs;
    std::vector<float*> outputs;
    in.resize(module.inputs.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
      const bool sample = module.inputs[i].rate == ir::Rate::sample;
      if (sample) in[i].resize(padded, from_bits(0x7fc12345u));
      inputs.push_back(sample ? in[i].data() : nullptr);
    }
    for (auto& column : out) outputs.push_back(column.data());
    kernel.run_samples(state, status, scratch, inputs.data(), outputs.data(), count);
    for (auto& column : out) column.resize(static_cast<std::size_t>(count));
    return out;
  }
};

// Runs on samples only.
inline Columns run(const TestProgram& program, const Machine& machine, const Columns& columns,
                   std::int64_t count) {
  const auto kernel = compile(program, machine);
  if (!kernel)
    return Columns(program.split.module.outputs.size(),
                   std::vector<float>(static_cast<std::size_t>(count)));
  Runner once;
  Columns out = once(*kernel, program.split.module,
                     std::vector<float>(program.split.module.inputs.size()), columns, count);
  EXPECT_EQ(once.status.failed_check.load(), -1);
  return out;
}

class OnEveryMachine : public ::testing::TestWithParam<Machine> {};

inline std::string machine_name(const ::testing::TestParamInfo<Machine>& info) {
  std::string name = info.param.cpu + "_x" + std::to_string(info.param.width);
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

}  // namespace pse::testing_support
