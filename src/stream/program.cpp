// The compiler from end to end: text -> tree -> IR -> passes -> kernel. The table of contents of a
// compilation.
#include "stream/program.h"

#include <chrono>
#include <utility>

#include "codegen/uniformity.h"
#include "ir/expectations.h"
#include "lang/parser.h"

namespace pse {
namespace {

// Seconds since the last call.
class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

std::optional<CompiledFront> compile_front(SourceMap& sources, FileId file, const LowerHost& host,
                                           const CompileOptions& options,
                                           Diagnostics& diagnostics) {
  CompiledFront front;
  Clock clock;

  // Text to tree.
  const lang::Program tree = lang::parse(sources, file, diagnostics);
  front.program.times.parse = clock.lap();
  if (diagnostics.has_errors()) {
    add_later_errors(sources, tree, host, options.lower, diagnostics);
    return std::nullopt;
  }

  // Tree to IR.
  Lowered lowered = lower_program(sources, tree, host, options.lower, diagnostics);
  front.program.times.lower = clock.lap();
  if (diagnostics.has_errors()) return std::nullopt;
  front.program.knobs = std::move(lowered.knobs);
  front.program.outputs = std::move(lowered.outputs);
  front.program.reads = std::move(lowered.reads);
  front.module = std::move(lowered.module);
  front.calls = std::move(lowered.calls);
  if (options.after_pass) options.after_pass("lower", front.module);
  return front;
}

std::expected<std::shared_ptr<const Program>, std::string> compile_back(
    CompiledFront front, const CompileOptions& options) {
  auto program = std::make_shared<Program>(std::move(front.program));
  Clock clock;

  // IR to IR. Expectations that nobody has settled have nobody to tell.
  ir::release_expected_values(front.module);
  const passes::PipelineOptions pipeline{.optimize = options.optimize,
                                         .calls = std::move(front.calls),
                                         .outline = options.outline,
                                         .after_pass = options.after_pass};
  program->split = std::make_shared<const passes::SplitModule>(
      passes::run_pipeline(std::move(front.module), pipeline));
  program->times.passes = clock.lap();

  program->parts = has_varying_loops(*program->split);

  // IR to kernel.
  if (options.interpret) {
    program->kernel = make_interpreted_kernel(program->split);
  } else {
    CodegenStats stats;
    auto kernel = make_kernel(program->split, options.codegen, options.tier, &stats);
    if (!kernel) return std::unexpected(kernel.error());
    program->kernel = std::move(*kernel);
    program->times.from_cache = stats.from_cache;
    program->times.first_tier = stats.first_tier;
    program->times.behind = stats.behind;
  }
  program->times.codegen = clock.lap();
  return program;
}

std::shared_ptr<const Program> compile(SourceMap& sources, FileId file, const LowerHost& host,
                                       const CompileOptions& options, Diagnostics& diagnostics) {
  auto front = compile_front(sources, file, host, options, diagnostics);
  if (!front) return nullptr;
  auto program = compile_back(std::move(*front), options);
  if (program) return *program;
  diagnostics.error("codegen", Span{}, program.error());
  return nullptr;
}

}  // namespace pse
