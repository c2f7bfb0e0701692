// libFuzzer: any bytes as a program that is compiled and run. What the lowering accepts goes
// through every pass, each of which must leave a sound module; the interpreter without passes says
// what it means, and the interpreter with passes and kernels of width 4 and 8 must give the same
// bits. With the sanitizers this holds over lower, ir, passes, codegen and stream; the library's
// own code (LLVM) is not instrumented. New inputs are random programs as well as changed bytes.
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include "ir/verifier.h"
#include "support/agreement.h"
#include "support/random_program.h"

namespace {

using namespace pse;

// Cancels runs that take their time: the input may loop for ever.
class Patience {
 public:
  explicit Patience(RunStatus& status)
      : thread_([this, &status](std::stop_token stop) {
          std::unique_lock lock(mutex_);
          if (!wake_.wait_for(lock, stop, std::chrono::milliseconds(300), [] { return false; }) &&
              !stop.stop_requested())
            status.cancel = true;
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::jthread thread_;
};

struct Compiled {
  std::shared_ptr<const Program> program;
  std::string complaint;
};

Compiled build(const std::string& text, bool optimize) {
  Compiled built;
  CompileOptions options;
  options.interpret = true;
  options.optimize = optimize;
  options.outline = {
      .min_total = 0, .min_size = 4, .min_saved = 1, .max_function = 0, .min_cut = 1};
  options.lower.max_instructions = 4'000;
  const test::RandomProgramOptions brings;
  for (const auto& [name, components] : brings.sample_inputs)
    options.lower.stream.push_back({name, components, ir::Rate::sample});
  for (const auto& [name, components] : brings.frame_inputs)
    options.lower.stream.push_back({name, components, ir::Rate::frame});
  options.after_pass = [&](std::string_view pass, const ir::Module& module) {
    const auto complaints = ir::verify(module);
    if (!complaints.empty() && built.complaint.empty())
      built.complaint = std::string(pass) + ": " + complaints.front();
  };
  SourceMap sources;
  Diagnostics diagnostics;
  built.program = compile(sources, sources.add("input", text), LowerHost{}, options, diagnostics);
  return built;
}

[[noreturn]] void disagree(const std::string& what) {
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

// Every fourth new input is a program that compiles, whole or in part.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned int seed) {
  if (seed % 4 != 0) return LLVMFuzzerMutate(data, size, most);
  test::RandomProgramOptions shape;
  shape.statements = 1 + static_cast<int>(seed / 4 % 6);
  const std::string text = test::RandomProgram(seed, shape).text();
  const std::size_t length = std::min(text.size(), most);
  std::memcpy(data, text.data(), length);
  return length;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const Compiled plain = build(text, false);
  if (!plain.complaint.empty()) disagree(plain.complaint);
  if (!plain.program) return 0;
  const Compiled optimised = build(text, true);
  if (!optimised.complaint.empty()) disagree(optimised.complaint);
  if (!optimised.program) disagree("the passes lose it");

  const auto run = [](const Kernel& kernel, const ir::Module& module, bool& ended) {
    RunStatus status;
    const Patience patience(status);
    auto result = test::run_kernel(kernel, module, 1, status);
    ended = ended && !status.cancel;
    return result;
  };
  bool ended = true;
  const auto expected = run(*plain.program->kernel, plain.program->module(), ended);
  const ir::Module& module = optimised.program->module();
  const auto interpreted = run(*optimised.program->kernel, module, ended);
  if (!ended) return 0;
  if (const std::string d = test::difference(expected, interpreted); !d.empty())
    disagree("the passes change it: " + d);

  for (const int width : {4, 8}) {
    const CodegenOptions options{.width = width,
                                 .cpu = {},
                                 .optimize = (size + static_cast<std::size_t>(width)) % 3 != 0,
                                 .compile_frame = size % 2 == 0,
                                 .cache = {}};
    const auto kernel = compile_kernel(*optimised.program->split, options);
    if (!kernel) disagree(kernel.error());
    const auto found = run(**kernel, module, ended);
    if (!ended) return 0;
    if (const std::string d = test::difference(expected, found); !d.empty())
      disagree("width " + std::to_string(width) + " differs: " + d);
  }
  return 0;
}
