// The compiler's middle as a table of contents.
#include "passes/pipeline.h"

#include <utility>

#include "passes/deriver.h"
#include "passes/passes.h"

namespace pse::passes {

SplitModule run_pipeline(ir::Module module, const PipelineOptions& options) {
  const auto after = [&](std::string_view pass, const ir::Module& result) {
    if (options.after_pass) options.after_pass(pass, result);
  };
  const auto run = [&](std::string_view name, auto&& pass, ir::Module& on) {
    pass(on);
    after(name, on);
  };

  // What the program does not need, and the slopes that it asks for.
  if (options.optimize)
    run(
        "remove-dead", [](ir::Module& m) { remove_dead(m); }, module);
  bool has_slopes = asks_for_slopes(module.main().body);
  if (has_slopes && options.optimize && !asks_when_folded(module)) {
    // Only in branches that are never taken: what stands there does not matter.
    forget_slopes(module);
    has_slopes = false;
  }
  if (has_slopes) run("slopes", resolve_slopes, module);

  if (options.optimize) {
    // What it calls. With slopes in between, the copies of a function are no longer alike.
    InlineOptions inlining;
    const std::vector<ir::CallRange> calls =
        has_slopes ? std::vector<ir::CallRange>{} : options.calls;
    run(
        "outline", [&](ir::Module& m) { inlining.first_kept = outline(m, calls, options.outline); },
        module);
    run(
        "inline", [&](ir::Module& m) { inline_calls(m, inlining); }, module);
    // Twice: selects made from ifs, and loops that fell away, show new constants.
    for (int round = 0; round < 2; ++round) {
      run("fold", fold, module);
      run("share", share, module);
      run("simplify-loops", simplify_loops, module);
      run(
          "unroll", [](ir::Module& m) { unroll(m); }, module);
      run("decide", decide, module);
      run(
          "convert-ifs", [](ir::Module& m) { convert_ifs(m); }, module);
    }
    run("fold", fold, module);
    run("hoist", hoist, module);
    run("share", share, module);
    run(
        "remove-dead", [](ir::Module& m) { remove_dead(m); }, module);
    // Whose work it is: the frame's or the sample's.
    run(
        "rates", [](ir::Module& m) { assign_rates(m); }, module);
    run("hoist-frame", hoist_frame, module);
  }
  SplitModule result = split(std::move(module));
  after("split", result.module);

  if (options.optimize) {
    // The slots' decoding, and what both functions hold a copy of.
    run("fold", fold, result.module);
    run("share", share, result.module);
    remove_dead(result);
    after("remove-dead", result.module);
  }
  run("compact", compact_values, result.module);
  assign_rates(result);
  after("rates", result.module);
  return result;
}

}  // namespace pse::passes
