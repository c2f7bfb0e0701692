// `pse render`: from arguments to files.
#include <fmt/format.h>

#include <chrono>

#include "app/compile_settings.h"
#include "app/emit.h"
#include "app/help.h"
#include "app/knobs.h"
#include "app/program_file.h"
#include "app/render_job.h"
#include "app/report.h"
#include "app/surfaces.h"
#include "lang/parser.h"

namespace pse::app {
namespace {

namespace fs = std::filesystem;

// The command's help, or with a program that program's knobs.
Exit show_help(Session& session) {
  const auto& words = session.arguments.positionals;
  if (words.empty()) {
    session.console.print(command_help(*session.arguments.command));
    return Exit::ok;
  }
  ProgramFile program = read_program(words.front(), session);
  Diagnostics diagnostics;
  const Lowered lowered = survey(program, module_host(program.path, session), diagnostics);
  if (diagnostics.has_errors()) report(diagnostics, program.sources, session);
  session.console.print(
      fmt::format("usage: pse render {} [IMAGE...] [Name=VALUE...] -o FILE\n\n", words.front()));
  session.console.print(knob_help(lowered.knobs));
  session.console.print("\n`pse render --help` lists the options.\n");
  return Exit::ok;
}

CompileOptions compile_options(const RenderOptions& options, const InputImages& images,
                               const Surfaces* surfaces,
                               const std::vector<KnobSetting>& settings,
                               const lang::Program& tree) {
  CompileOptions compile = compile_settings(options, settings);
  // The names of images hide those of surfaces, and these those of the plane.
  compile.lower.stream = images.names();
  if (surfaces != nullptr)
    for (const StreamName& name : surfaces->names()) compile.lower.stream.push_back(name);
  for (const StreamName& name : image_plane_names()) compile.lower.stream.push_back(name);
  compile.lower.outputs = wanted_variables(options, tree);
  return compile;
}

}  // namespace

Exit render_command(Session& session) {
  if (session.arguments.has("help")) return show_help(session);
  const auto start = std::chrono::steady_clock::now();
  Signals signals;

  // Read the arguments, the program and the heads of the images.
  const RenderOptions options = render_options(session);
  const std::string stage = session.arguments.text_or("emit", "");
  const std::string stats = session.arguments.text_or("stats", "");
  if (options.outputs.empty() && stage.empty() && stats.empty())
    throw usage_error("where should the picture go?",
                      fmt::format("-o {}.png", fs::path(options.program).stem().string()));
  const std::vector<KnobSetting> settings = knob_settings(session, options.knob_words);
  ProgramFile program = read_program(options.program, session);
  InputImages images(options, session);
  images.open(choose_frames(options).front());
  std::unique_ptr<Surfaces> surfaces;
  if (wants_surfaces(options)) surfaces = std::make_unique<Surfaces>(options, session);

  // Compile.
  Diagnostics diagnostics;
  Diagnostics ignored;  // compile() parses again and reports
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  CompileOptions compile_with = compile_options(options, images, surfaces.get(), settings, tree);
  LowerHost host = module_host(program.path, session);
  Textures textures(session, program.path, options.write.working);
  textures.answer(host);
  if (!stage.empty()) {
    const std::string text = emit_stage(stage, program, host, compile_with, diagnostics);
    session.console.print(text);
    report(diagnostics, program.sources, session);
    return Exit::ok;
  }
  OperationCounts operations;
  if (!stats.empty())
    compile_with.after_pass = [&](std::string_view pass, const ir::Module& module) {
      count_written(pass, module, operations);
    };
  auto front = compile_front(program.sources, program.file, host, compile_with, diagnostics);
  report(diagnostics, program.sources, session);
  if (!front) return Exit::program;
  auto programs =
      antialias::compile_programs(
      std::move(*front), compile_with,
      surfaces ? antialias::Mode::none : options.antialias.mode);
  if (!programs) throw Failure(Exit::program, programs.error());
  const std::shared_ptr<const Program>& compiled = programs->shown;
  const std::vector<Knob> knobs = apply_settings(compiled->knobs, settings, session.console);

  textures.load(compiled->module());
  if (surfaces) {
    std::vector<SurfaceProgram> parts;
    parts.push_back({compiled, knobs, &textures});
    programs->shown = programs->quiet = surfaces->combine(std::move(parts));
    programs->edges = {};
  } else if (const std::string problem = needs_a_scene(compiled->module()); !problem.empty()) {
    throw usage_error(problem, "--on SHAPE or --scene FILE");
  }

  // Run.
  RenderJob job(session, options, program.sources, program.file, *programs, knobs, images, textures,
                surfaces.get(), signals);
  const Exit exit = job.run();
  if (!stats.empty()) {
    RunStats numbers = job.stats();
    numbers.operations.written = operations.written;
    numbers.total_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (stats == "json")
      session.console.print(stats_json(numbers));
    else
      session.console.raw_error(stats_text(numbers));
  }
  return exit;
}

}  // namespace pse::app
