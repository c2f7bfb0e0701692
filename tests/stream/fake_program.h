// Programs for the executor's tests whose kernel is a C++ function, so that each test knows what
// must come out.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "stream/program.h"

namespace pse::test {

using SampleFunction = std::function<void(const float* const* inputs, float* const* outputs,
                                          std::int64_t count, RunStatus& status)>;

class FunctionKernel : public Kernel {
 public:
  FunctionKernel(SampleFunction samples, std::function<void(FrameState&, RunStatus&)> frame)
      : samples_(std::move(samples)), frame_(std::move(frame)) {}
  int width() const override { return 16; }
  void run_frame(FrameState& state, RunStatus& status) const override {
    if (frame_) frame_(state, status);
  }
  void run_samples(const FrameState&, RunStatus& status, Scratch&, const float* const* inputs,
                   float* const* outputs, std::int64_t count) const override {
    samples_(inputs, outputs, count, status);
  }

 private:
  SampleFunction samples_;
  std::function<void(FrameState&, RunStatus&)> frame_;
};

inline Program fake_program(const std::vector<ir::Input>& inputs,
                            const std::vector<std::string>& outputs, SampleFunction samples,
                            std::function<void(FrameState&, RunStatus&)> frame = {}) {
  auto split = std::make_shared<passes::SplitModule>();
  split->module.inputs = inputs;
  for (const std::string& name : outputs) split->module.outputs.push_back({name});
  Program program;
  program.split = split;
  program.kernel = std::make_shared<FunctionKernel>(std::move(samples), std::move(frame));
  return program;
}

// Copies input plane i to output plane i.
inline void copy_planes(const float* const* inputs, float* const* outputs, std::int64_t count,
                        RunStatus&, int planes) {
  for (int p = 0; p < planes; ++p) std::copy_n(inputs[p], count, outputs[p]);
}

}  // namespace pse::test
