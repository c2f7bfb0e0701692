// Compiling them from one lowered module.
#include "antialias/programs.h"

#include <chrono>

#include "antialias/force.h"
#include "antialias/kept.h"
#include "antialias/path.h"
#include "ir/expectations.h"
#include "passes/passes.h"

namespace pse::antialias {

std::expected<Programs, std::string> compile_programs(CompiledFront front,
                                                      const CompileOptions& options, Mode mode,
                                                      const InputChanges& changes,
                                                      const Filter& filter,
                                                      Expectations expectations) {
  // For all but the program that is shown, whose passes may be watched.
  const CompileOptions plain{.codegen = options.codegen,
                             .tier = options.tier,
                             .interpret = options.interpret,
                             .optimize = options.optimize};
  if (expectations == Expectations::reported && ir::has_expectations(front.module)) {
    // Those alone whose values the outputs need.
    passes::remove_dead(front.module, {.arrays = false, .functions = false});
    passes::settle_expectations(front.module);
  } else {
    ir::drop_expectations(front.module);
  }
  Programs programs;
  programs.outputs = front.module.outputs.size();
  programs.kept = std::make_shared<Kept>();
  const auto finish = [&](CompiledFront&& with_checks) -> std::expected<Programs, std::string> {
    std::optional<CompiledFront> without;
    if (mode != Mode::none) {
      without = with_checks;
      remove_checks(without->module);
    }
    auto shown = compile_back(std::move(with_checks), options);
    if (!shown) return std::unexpected(shown.error());
    programs.shown = programs.quiet = *shown;
    // Checks that cannot fail are gone by now.
    if (mode == Mode::none || !has_checks((*shown)->module())) return std::move(programs);
    auto quiet = compile_back(std::move(*without), plain);
    if (!quiet) return std::unexpected(quiet.error());
    programs.quiet = *quiet;
    return std::move(programs);
  };
  if (mode != Mode::procedural) return finish(std::move(front));

  // Decisions are those of what the outputs need.
  CompiledFront copy = front;
  copy.calls.clear();
  passes::remove_dead(copy.module);
  const Decisions decisions = find_decisions(copy.module, changes);
  programs.courses = find_courses(copy.module, decisions);
  if (!decisions.any && !decisions.any_noise) return finish(std::move(front));
  programs.has_paths = true;
  programs.has_untold_noise = decisions.noises.others;
  if (!decisions.any) {
    programs.has_only_noise = true;
    add_path(copy.module, decisions);
    return finish(std::move(copy));
  }
  programs.conditions = std::async(std::launch::deferred, [open = copy, plain]() mutable {
                          const std::size_t own = open.module.outputs.size();
                          remove_checks(open.module);
                          open_conditions(open.module);
                          for (std::size_t o = own; o < open.module.outputs.size(); ++o)
                            open.program.outputs.push_back({open.module.outputs[o].name, 1, {}});
                          return compile_back(std::move(open), plain);
                        }).share();
  CompiledFront edges = copy;
  // Where nothing jumps there is seldom a visible edge, and it may never be asked for.
  const auto when = decisions.any_jump ? std::launch::async : std::launch::deferred;
  const auto derive = [edges = std::move(edges), decisions, plain, changes]() mutable {
    remove_checks(edges.module);
    derive_edges(edges.module, decisions, changes);
    edges.program.outputs.clear();
    for (const ir::Output& output : edges.module.outputs)
      edges.program.outputs.push_back({output.name, 1, {}});
    return compile_back(std::move(edges), plain);
  };
  programs.edges = std::async(when, derive).share();
  add_path(copy.module, decisions, std::max(filter.reach(), usual_reach));
  return finish(std::move(copy));
}

TierSamples tier_samples(const Programs& programs) {
  TierSamples sum;
  const auto add = [&](const std::shared_ptr<const Program>& program) {
    const TierSamples runs = program->kernel->tier_samples();
    sum.first += runs.first;
    sum.optimised += runs.optimised;
  };
  const auto add_if_made = [&](const std::shared_future<Programs::Result>& made) {
    using namespace std::chrono_literals;
    if (made.valid() && made.wait_for(0s) == std::future_status::ready && made.get())
      add(*made.get());
  };
  add(programs.shown);
  if (programs.quiet != programs.shown) add(programs.quiet);
  add_if_made(programs.edges);
  add_if_made(programs.conditions);
  return sum;
}

}  // namespace pse::antialias
