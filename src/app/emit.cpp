// Stopping the compiler at a stage.
#include "app/emit.h"

#include "ir/text.h"
#include "lang/parser.h"

namespace pse::app {

std::string emit_stage(const std::string& stage, ProgramFile& program, const LowerHost& host,
                       const CompileOptions& options, Diagnostics& diagnostics) {
  // Text and tree.
  if (stage == "tokens") return lang::print_tokens(program.sources, program.file);
  const lang::Program tree = lang::parse(program.sources, program.file, diagnostics);
  if (stage == "ast") return lang::print_ast(tree);
  if (diagnostics.has_errors()) return {};

  // IR before and after the passes.
  Lowered lowered = lower_program(program.sources, tree, host, options.lower, diagnostics);
  if (diagnostics.has_errors()) return {};
  if (stage == "ir") return ir::print(lowered.module);
  const passes::SplitModule split =
      passes::run_pipeline(std::move(lowered.module), {.optimize = options.optimize,
                                                       .calls = std::move(lowered.calls)});
  if (stage == "opt") return ir::print(split.module);

  // What LLVM makes of it.
  const auto text =
      emit_listing(split, options.codegen, stage == "llvm" ? Listing::llvm : Listing::assembly);
  if (!text) throw Failure(Exit::running, text.error());
  return *text;
}

}  // namespace pse::app
