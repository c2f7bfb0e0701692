// `pse bake`: a program over a lattice, or a mesh's distances, into a VDB file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "app/atlas_command.h"
#include "app/bake_job.h"
#include "app/bake_mesh.h"
#include "app/compile_settings.h"
#include "app/function_program.h"
#include "app/knobs.h"
#include "app/report.h"
#include "lang/parser.h"

namespace pse::app {
namespace {

namespace fs = std::filesystem;

// The grids to make: those asked for, or those of the usual names that the program has.
struct GridNames {
  std::vector<std::string> names;
  bool from_functions = false;  // the functions of these names, not variables
};

GridNames choose_grids(const lang::Program& tree, const OutputRequest& request) {
  GridNames grids;
  // A program that sets `density` says what it means; in others the functions do, and what they
  // set is their picture.
  const bool has_functions = std::any_of(usual_grids.begin(), usual_grids.end(), [&](auto name) {
    return required_parameters(tree, std::string(name)) >= 1;
  });
  const bool sets = std::any_of(usual_grids.begin(), usual_grids.end(), [&](auto name) {
    return name != "color" && sets_at_top(tree, std::string(name));
  });
  grids.from_functions = has_functions && !sets;
  const auto has = [&](const std::string& name) {
    if (!grids.from_functions) return sets_at_top(tree, name);
    const int parameters = required_parameters(tree, name);
    return parameters == 1 ||
           (parameters == 2 && name != "density" && required_parameters(tree, "density") == 1);
  };
  if (!request.variables.empty()) {
    for (const std::string& name : request.variables)
      if (!has(name))
        throw usage_error(fmt::format("the program has no {} `{}` to make a grid of",
                                      grids.from_functions ? "function" : "variable", name));
    grids.names = request.variables;
    return grids;
  }
  for (const std::string_view name : usual_grids)
    if (has(std::string(name))) grids.names.emplace_back(name);
  const std::string more = density_wants_more(tree);
  if (grids.names.empty() && !more.empty())
    throw Failure(Exit::program, more, "function density(p, ray = 0)");
  if (grids.names.empty())
    throw Failure(Exit::program,
                  fmt::format("the program has nothing to make grids of: it neither sets {} nor "
                              "has a function density(p)",
                              fmt::join(usual_grids, ", ")),
                  "function density(p)");
  return grids;
}

}  // namespace

Exit bake_command(Session& session) {
  if (wants_atlas(session.arguments)) return bake_atlas(session);
  Signals signals;
  const VolumeOptions options = bake_options(session);
  const RenderOptions& common = options.common;
  if (common.outputs.empty())
    throw usage_error("where should the volume go?",
                      fmt::format("-o {}.vdb", fs::path(common.program).stem().string()));
  const OutputRequest& request = common.outputs.front();
  if (!request.file.ends_with(".vdb"))
    throw usage_error(fmt::format("`{}` is no VDB file", request.file), "-o cloud.vdb");

  if (is_mesh_name(common.program)) return bake_mesh(session, options, signals);

  // The program, with calls of its functions where it sets nothing itself.
  const std::vector<KnobSetting> settings = knob_settings(session, common.knob_words);
  ProgramFile program = read_program(common.program, session);
  Diagnostics diagnostics, ignored;
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  GridNames grids;
  if (!ignored.has_errors()) {
    grids = choose_grids(tree, request);
    if (grids.from_functions) append_lines(program, calls_at_point(tree, grids.names));
  }

  // Compile.
  CompileOptions compile_with = compile_settings(common, settings);
  compile_with.lower.stream = volume::lattice_names();
  compile_with.lower.outputs = grids.names;
  LowerHost host = module_host(program.path, session);
  Textures stored(session, program.path, common.write.working);
  stored.answer(host);
  auto compiled = compile(program.sources, program.file, host, compile_with, diagnostics);
  report(diagnostics, program.sources, session);
  if (!compiled) return Exit::program;
  // What a function of the program is to blame for is told at that function.
  if (grids.from_functions) {
    auto named = std::make_shared<Program>(*compiled);
    for (ProgramOutput& output : named->outputs)
      if (const auto head = function_head(tree, output.name)) output.span = *head;
    compiled = std::move(named);
  }
  const std::vector<Knob> knobs = apply_settings(compiled->knobs, settings, session.console);
  report(stored.load(compiled->module()), program.sources, session);

  return BakeJob(session, options, program.sources, program.file, compiled, knobs, stored, signals)
      .run();
}

}  // namespace pse::app
