// From text to something that runs: the whole compiler behind one call, and what a host needs to
// know of the result.
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <string>

#include "codegen/kernel.h"
#include "diag/diagnostics.h"
#include "lower/lower.h"
#include "passes/pipeline.h"

namespace pse {

struct CompileOptions {
  LowerOptions lower;
  CodegenOptions codegen;
  Tier tier = Tier::optimised;
  bool interpret = false;  // run by the interpreter instead of compiled code
  bool optimize = true;
  passes::OutlineOptions outline;
  std::function<void(std::string_view pass, const ir::Module&)> after_pass;
};

struct CompileTimes {
  double parse = 0, lower = 0, passes = 0, codegen = 0;  // seconds
  double behind = 0;  // CodegenStats::behind
  bool from_cache = false, first_tier = false;
};

// A compiled program. Immutable; share it between threads and runs.
struct Program {
  std::vector<Knob> knobs;
  std::vector<ProgramOutput> outputs;
  std::vector<std::string> reads;
  std::shared_ptr<const passes::SplitModule> split;
  std::shared_ptr<const Kernel> kernel;
  bool parts = false;  // samples may leave its loops at different turns
  CompileTimes times;

  const ir::Module& module() const { return split->module; }
};

// Compiles file `file` of `sources`. Null after errors, which are in `diagnostics`.
std::shared_ptr<const Program> compile(SourceMap& sources, FileId file, const LowerHost& host,
                                       const CompileOptions& options, Diagnostics& diagnostics);

// The first half of it: text to the IR as the lowering leaves it.
struct CompiledFront {
  Program program;  // without split and kernel
  ir::Module module;
  std::vector<ir::CallRange> calls;  // in `module`; to be cleared where that is rewritten
};
std::optional<CompiledFront> compile_front(SourceMap& sources, FileId file, const LowerHost& host,
                                           const CompileOptions& options, Diagnostics& diagnostics);
// The second half: passes and kernel. The error is a sentence for the user.
std::expected<std::shared_ptr<const Program>, std::string> compile_back(
    CompiledFront front, const CompileOptions& options);

}  // namespace pse
