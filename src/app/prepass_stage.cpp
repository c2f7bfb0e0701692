// From options to images of spans.
#include "app/prepass_stage.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>

#include "app/compile_settings.h"
#include "app/function_program.h"
#include "app/prepass_proof.h"
#include "app/render_job.h"
#include "app/report.h"
#include "bounds/bounds.h"
#include "image/sequence.h"
#include "lang/parser.h"

namespace pse::app {

PrepassStage::~PrepassStage() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

namespace {

// Whether a program's span looks for matter in steps; one of its own making tells no density.
bool takes_steps(const ir::Module& module) {
  return std::any_of(module.inputs.begin(), module.inputs.end(),
                     [](const ir::Input& input) { return input.name == "prepass.step"; });
}

// The program of the bounds of `span`'s depth and density; null where it cannot be made.
std::shared_ptr<const Program> compile_bounds(ProgramFile& program, const LowerHost& host,
                                              const CompileOptions& options) {
  Diagnostics ignored;
  auto front = compile_front(program.sources, program.file, host, options, ignored);
  if (!front) return nullptr;
  front->calls.clear();
  bounds::bound_outputs(front->module, {.known = {{"prepass.step", -1.0f}}});
  front->program.outputs.clear();
  for (const ir::Output& output : front->module.outputs)
    front->program.outputs.push_back({output.name, 1, {}});
  auto made = compile_back(std::move(*front), options);
  return made ? *made : nullptr;
}

// A program that marches by one call of the library and sets no span: a line that sets it, by the
// function that has the same arguments. Empty where there is no such call.
std::string span_line(const ProgramFile& program, const lang::Program& tree) {
  for (const std::string marcher : {"hypertexture", "raymarch"})
    if (const auto call = find_call(tree, marcher))
      return fmt::format("span = {}_span{}\n", marcher,
                         program.sources.text(*call).substr(marcher.size()));
  return {};
}

// That something may be missing, how much was looked at, and what to do about it.
std::string what_is_left(const PrepassReport& report, int factor) {
  return fmt::format(
      "the prepass took samples only of {:.0f} % of what the rays pass through: specks thinner "
      "than {} pixels or steps may be missing there (of {} later samples that met matter, {} met "
      "some that was new). Without --prepass none is",
      std::ceil(100 * report.left), factor, report.met, report.met_new);
}

}  // namespace

Exit PrepassStage::run(Session& session, RenderOptions& options, const ProgramFile& rendered,
                       const std::vector<KnobSetting>& settings, Signals& signals) {
  Diagnostics diagnostics, ignored;
  ProgramFile program = rendered;
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  if (ignored.has_errors()) return Exit::ok;  // the render reports them
  if (!sets_at_top(tree, "span")) {
    const std::string line = span_line(program, tree);
    if (line.empty())
      throw usage_error(
          "the program does not say where matter is: it sets no `span`, and no color by "
          "hypertexture() or raymarch()",
          "span = raymarch_interval(density, origin, dir, near, far, step)");
    append_lines(program, line);
  }
  if (!options.images.empty() || !options.on.empty())
    throw usage_error("--prepass works on the image plane, without images and surfaces");

  // The program again, for its spans alone.
  CompileOptions compile_with = compile_settings(options, settings);
  compile_with.lower.stream = image_plane_names();
  compile_with.lower.outputs = {"span"};
  const bool counts = options.count_evaluations && sets_at_top(tree, "evaluations");
  if (counts) compile_with.lower.outputs.emplace_back("evaluations");
  LowerHost host = module_host(program.path, session);
  Textures stored(session, program.path, options.write.working);
  stored.answer(host);
  const auto compiled = compile(program.sources, program.file, host, compile_with, diagnostics);
  report(diagnostics, program.sources, session);
  if (!compiled) throw Failure(Exit::program, "");
  for (const ProgramOutput& output : compiled->outputs)
    if (output.name == "span" && output.components != 2)
      throw Failure(Exit::program, "`span` is a vector of two: [near far]");
  const std::vector<Knob> knobs = apply_settings(compiled->knobs, settings, session.console);
  report(stored.load(compiled->module()), program.sources, session);
  CompileOptions bound_with = compile_with;
  bound_with.lower.outputs = {"span"};
  const bool steps = takes_steps(compiled->module());
  const auto bounded = steps ? compile_bounds(program, host, bound_with) : nullptr;
  // A span without steps is asked for in every pixel, and is what the program says.
  const int factor = steps ? options.prepass : 1;

  // One image per frame.
  const Resolution size = options.resolution.value_or(Resolution{512, 512});
  std::string pattern = options.prepass_image;
  if (pattern.empty()) {
    std::string name = (std::filesystem::temp_directory_path() / "pse-prepass-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw Failure(Exit::output, "there is no folder for the prepass's images");
    folder_ = name;
    pattern = (folder_ / "span.%04d.exr").string();
  }
  const std::vector<int> frames = choose_frames(options);
  if (frames.size() > 1 && !image::is_pattern(pattern))
    throw usage_error(fmt::format("what the prepass finds in {} frames would all go to `{}`",
                                  frames.size(), pattern),
                      "put %04d into the name where the frame's number should stand");
  RunStatus status;
  const SignalWatch watch(signals, status);
  PrepassReport total{.possible = 0, .step = factor};
  for (const int frame : frames) {
    const ImagePlane plane{.width = size.width,
                           .height = size.height,
                           .frame = double(frame),
                           .fps = options.fps,
                           .seed = options.seed,
                           .transform = options.transform};
    SpanSearch search(*compiled, plane, knobs, stored.functions(), options.threads, status);
    std::optional<BoxBounds> bounds;
    if (bounded)
      bounds.emplace(*bounded, plane, knobs, stored.functions(), options.threads, status);
    PrepassReport found;
    const auto spans =
        find_spans(search, bounds ? &*bounds : nullptr, size.width, size.height, factor, found);
    if (const int signal = signals.stop_signal()) return static_cast<Exit>(128 + signal);
    if (!spans) {
      const auto check = static_cast<std::size_t>(std::max(0, status.failed_check.load()));
      throw Failure(Exit::running, check < compiled->module().checks.size()
                                       ? compiled->module().checks[check].message
                                       : "the prepass stopped");
    }
    write_spans(*spans, size.width, size.height, *image::frame_name(pattern, frame));
    total.missed += found.missed;
    if (found.missed > 0) total.step = std::min(total.step, found.step);
    total.evaluations += found.evaluations, total.boxes += found.boxes;
    total.possible = std::max(total.possible, found.possible);
    if (found.left > 0) total.met += found.met, total.met_new += found.met_new;
    total.left = std::max(total.left, found.left);
  }
  if (total.missed > 0)
    session.console.warning(
        "prepass",
        fmt::format(
            "the prepass did not see all matter at first: some is thinner than {} pixels or "
            "steps. {}, which takes longer",
            options.prepass,
            total.step > 1 ? fmt::format("It looked again in steps of {}", total.step)
                           : "All that may hold matter is marched through"));
  if (steps && total.left > 0)
    session.console.warning("prepass", what_is_left(total, options.prepass));
  if (counts)
    session.console.note(fmt::format("prepass: {:.0f} density evaluations", total.evaluations));
  if (options.count_evaluations && bounded)
    session.console.note(fmt::format(
        "prepass: the bounds of {} boxes leave {:.1f} % of the rays that may hold matter{}",
        total.boxes, 100 * total.possible,
        total.left > 0 ? ", which was sampled" : "; nothing is missed"));
  options.images.push_back({"prepass", pattern, true});
  return Exit::ok;
}

}  // namespace pse::app
