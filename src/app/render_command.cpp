// `pse render`: from arguments to files.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "app/compile_settings.h"
#include "app/emit.h"
#include "app/function_program.h"
#include "app/help.h"
#include "app/knobs.h"
#include "app/prepass_stage.h"
#include "app/program_file.h"
#include "app/render_job.h"
#include "app/report.h"
#include "app/surfaces.h"
#include "app/text_file.h"
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
                               const Surfaces* surfaces, const std::vector<KnobSetting>& settings,
                               const lang::Program& tree) {
  CompileOptions compile = compile_settings(options, settings);
  // The names of images hide those of surfaces, and these those of the plane.
  compile.lower.stream = images.names();
  if (surfaces != nullptr)
    for (const StreamName& name : surfaces->names()) compile.lower.stream.push_back(name);
  for (const StreamName& name : image_plane_names(options.transform))
    compile.lower.stream.push_back(name);
  compile.lower.outputs = wanted_variables(options, tree);
  return compile;
}

// Both lists; the second counts where they name the same.
std::vector<KnobSetting> joined(std::vector<KnobSetting> first,
                                const std::vector<KnobSetting>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::vector<KnobSetting> known(std::vector<KnobSetting> settings, const std::vector<Knob>& knobs) {
  std::erase_if(settings, [&](const KnobSetting& setting) {
    return std::none_of(knobs.begin(), knobs.end(),
                        [&](const Knob& knob) { return knob.name == setting.name; });
  });
  return settings;
}

// Makes the density the picture, for --slice.
void show_density(ProgramFile& program) {
  Diagnostics ignored;
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  if (ignored.has_errors()) return;  // the compiler reports them
  const bool sets = sets_at_top(tree, "density");
  const std::string more = sets ? "" : density_wants_more(tree);
  if (!more.empty()) throw usage_error(more, "function density(p, ray = 0)");
  if (!sets && required_parameters(tree, "density") != 1)
    throw usage_error("--slice shows the density, and the program has none", "function density(p)");
  append_lines(program, (sets ? "" : calls_at_point(tree, {"density"})) +
                            "color = [density density density]\nalpha = 1\n");
}

// Makes a program that is a density and no more a picture.
void show_matter(ProgramFile& program) {
  Diagnostics ignored;
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  if (ignored.has_errors()) return;  // the compiler reports them
  const std::string line = hypertexture_line(tree);
  if (!line.empty()) append_lines(program, line);
}

}  // namespace

Exit render_command(Session& session) {
  if (session.arguments.has("help")) return show_help(session);
  const auto start = std::chrono::steady_clock::now();
  Signals signals;

  // Read the arguments, the program and the heads of the images.
  RenderOptions options = render_options(session);
  const std::string stage = session.arguments.text_or("emit", "");
  const std::string stats = session.arguments.text_or("stats", "");
  if (options.outputs.empty() && stage.empty() && stats.empty())
    throw usage_error("where should the picture go?",
                      fmt::format("-o {}.png", fs::path(options.program).stem().string()));
  const std::vector<KnobSetting> settings = knob_settings(session, options.knob_words);
  ProgramFile program;
  if (options.trace)
    program.file = program.sources.add("<trace>", trace_program);
  else
    program = read_program(options.program, session);
  if (options.slice)
    show_density(program);
  else if (!wants_surfaces(options) && options.images.empty())
    show_matter(program);
  PrepassStage prepass;
  if (options.prepass > 0)
    if (const Exit stopped = prepass.run(session, options, program, settings, signals);
        stopped != Exit::ok)
      return stopped;
  InputImages images(options, session);
  images.open(choose_frames(options).front());
  std::unique_ptr<Surfaces> surfaces;
  if (wants_surfaces(options))
    surfaces = std::make_unique<Surfaces>(options, session);
  else
    surfaces = Surfaces::stored(options, session, images);
  if (!options.camera.empty() && !surfaces)
    throw usage_error("--camera needs something to look at", "--on SHAPE or --scene FILE");

  // Compile: one program, or those of a scene.
  OperationCounts operations;
  std::optional<antialias::Programs> programs;
  std::vector<SurfaceProgram> parts;
  const std::vector<ProgramRequest> requests =
      surfaces ? surfaces->programs() : std::vector<ProgramRequest>(1);
  for (const ProgramRequest& request : requests) {
    FileId file = program.file;
    const std::string path = request.file.empty() ? program.path : request.file;
    if (!request.file.empty()) file = program.sources.add(path, read_text_file(path));
    const std::vector<KnobSetting> given = joined(request.knobs, settings);
    Diagnostics diagnostics;
    Diagnostics ignored;  // compile_front() parses again and reports
    const lang::Program tree = lang::parse(program.sources, file, ignored);
    CompileOptions compile_with = compile_options(options, images, surfaces.get(), given, tree);
    LowerHost host = module_host(path, session);
    auto textures = std::make_unique<Textures>(session, path, options.write.working);
    textures->answer(host);
    if (!stage.empty()) {
      ProgramFile shown{program.sources, file, path};
      session.console.print(emit_stage(stage, shown, host, compile_with, diagnostics));
      report(diagnostics, shown.sources, session);
      continue;
    }
    OperationCounts counts;
    if (!stats.empty())
      compile_with.after_pass = [&](std::string_view pass, const ir::Module& module) {
        count_written(pass, module, counts);
      };
    auto front = compile_front(program.sources, file, host, compile_with, diagnostics);
    report(diagnostics, program.sources, session);
    if (!front) return Exit::program;
    auto made = antialias::compile_programs(
        std::move(*front), compile_with, options.antialias.mode,
        surfaces ? unknown_changes : image_plane_changes(options.transform),
        options.antialias.filter, antialias::Expectations::reported);
    if (!made) throw Failure(Exit::program, made.error());
    count_compiled(*made->shown->split, counts);
    operations.add(counts);
    // Of several programs each takes the knobs that it has.
    const std::vector<Knob>& own = made->shown->knobs;
    std::vector<Knob> knobs = apply_settings(
        own, requests.size() > 1 ? joined(request.knobs, known(settings, own)) : given,
        session.console);
    report(textures->load(made->shown->module()), program.sources, session);
    auto expectations = std::make_unique<Expectations>(made->shown->module());
    parts.push_back(
        {std::move(*made), std::move(knobs), std::move(textures), std::move(expectations)});
  }
  if (!stage.empty()) return Exit::ok;
  if (surfaces) surfaces->load(options, session);
  const std::vector<Knob> knobs = parts.front().knobs;
  programs = parts.front().programs;
  const Textures no_textures(session, program.path, options.write.working);
  std::unique_ptr<Textures> own_textures;
  if (surfaces) {
    programs = surfaces->combine(std::move(parts), options.antialias.mode);
    if (requests.size() > 1) apply_settings(programs->shown->knobs, settings, session.console);
  } else {
    own_textures = std::move(parts.front().textures);
    if (const std::string problem = needs_a_scene(programs->shown->module()); !problem.empty())
      throw usage_error(problem, "--on SHAPE or --scene FILE");
  }

  // Run.
  RenderJob job(session, options, program.sources, program.file, *programs, knobs, images,
                own_textures ? *own_textures : no_textures, surfaces.get(), signals);
  const Exit exit = job.run();
  if (!stats.empty()) {
    RunStats numbers = job.stats();
    numbers.operations.add(operations);
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
