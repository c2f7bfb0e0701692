// From a mesh's texture coordinates to texture files: lay out the atlas, run the program at its
// samples, write what it sets. Solid texture for programs that know only pictures: 1985 paper,
// "Space Functions and Solid Texture", the other way round.
#include "app/atlas_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/compile_settings.h"
#include "app/output_plan.h"
#include "app/program_file.h"
#include "app/render_job.h"
#include "app/report.h"
#include "image/sequence.h"
#include "lang/parser.h"
#include "surface/atlas.h"
#include "surface/shape_words.h"

namespace pse::app {
namespace {

namespace fs = std::filesystem;

struct AtlasOptions {
  RenderOptions common;
  std::string mesh;  // its file, with settings behind it as for --on
  surface::AtlasSize size{.width = 2048, .height = 2048, .samples = 1};
  int margin = 16;
};

constexpr double most_samples = 1 << 28;

AtlasOptions atlas_options(const Session& session) {
  AtlasOptions options;
  Session rest = session;
  for (const char* own : {"res", "udim", "dilate"}) rest.arguments.options.erase(own);
  options.common = render_options(rest);
  if (options.common.outputs.empty())
    throw usage_error("where should the texture go?", "-o albedo.png");
  if (options.common.images.empty()) throw usage_error("no mesh is named");
  options.mesh = options.common.images.front().file;
  const Arguments& arguments = session.arguments;
  if (const auto value = arguments.value("res")) {
    const Resolution size = parse_resolution(*value);
    options.size.width = size.width, options.size.height = size.height;
  }
  if (const auto value = arguments.value("samples")) {
    const int samples = parse_integer(*value, 1, 256);
    options.size.samples = static_cast<int>(std::lround(std::ceil(std::sqrt(samples))));
  }
  if (const auto value = arguments.value("udim"))
    options.size.tile = parse_integer(*value, 1001, 9999);
  if (const auto value = arguments.value("dilate")) options.margin = parse_integer(*value, 0, 4096);
  const auto& s = options.size;
  if (double(s.width) * s.height * s.samples * s.samples > most_samples)
    throw usage_error(fmt::format("{}x{} texels of {} samples are too many", s.width, s.height,
                                  s.samples * s.samples));
  if (options.common.frames.size() > 1)
    for (const OutputRequest& output : options.common.outputs)
      if (!image::is_pattern(output.file))
        throw usage_error(fmt::format("{} frames would all go to `{}`",
                                      options.common.frames.size(), output.file),
                          "put %04d into the name where the frame's number should stand");
  return options;
}

std::shared_ptr<const surface::Mesh> read_mesh(const AtlasOptions& options, Session& session) {
  const auto spec = surface::parse_shape(options.mesh);
  if (!spec) throw usage_error(spec.error().message, spec.error().hint);
  surface::MeshOptions reading{.fit = true};
  for (const surface::Setting& setting : spec->settings) {
    if (setting.key == "fit" && setting.numbers.size() == 1)
      reading.fit = setting.numbers.front() != 0;
    else if (setting.key == "crease" && setting.numbers.size() == 1)
      reading.crease = setting.numbers.front();
    else
      throw usage_error(fmt::format("a mesh has no setting `{}`", setting.text),
                        "it has fit and crease");
  }
  const auto loaded = surface::load_mesh(session.find_file(spec->shape), reading);
  if (!loaded) throw Failure(Exit::input, loaded.error());
  for (const std::string& note : loaded->notes) session.console.warning("mesh", note);
  return loaded->mesh;
}

// The program's results at every sample: one plane per output.
RunResult run(const Program& program, FrameState state, const surface::Mesh& mesh,
              const surface::Atlas& atlas, int threads, Progress& progress, RunStatus& status,
              std::vector<std::vector<float>>& planes) {
  constexpr int row = 4096;
  const std::size_t count = atlas.samples.size();
  planes.assign(program.module().outputs.size(), std::vector<float>(count));
  const auto sink = [&](const TileView& tile) {
    for (std::size_t o = 0; o < planes.size(); ++o) {
      const float* from = tile.planes[o];
      for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
        for (int x = tile.rect.x0; x < tile.rect.x1; ++x, ++from)
          if (const auto i = static_cast<std::size_t>(std::int64_t{y} * row + x); i < count)
            planes[o][i] = *from;
    }
  };
  const int rows = static_cast<int>((count + row - 1) / row);
  return execute(program, state, surface::atlas_source(program.module(), mesh, atlas, row), sink,
                 {.window = {0, 0, rows == 1 ? static_cast<int>(count) : row, rows},
                  .tile_width = row,
                  .tile_height = 1,
                  .threads = threads,
                  .progress = [&](double done) { progress.update(done); }},
                 status);
}

}  // namespace

bool wants_atlas(const Arguments& arguments) {
  const auto outputs = arguments.all("output");
  const bool volume = std::any_of(outputs.begin(), outputs.end(), [](const OptionValue& output) {
    return output.text.ends_with(".vdb");
  });
  if (volume || arguments.positionals.size() < 2) return false;
  return std::any_of(arguments.positionals.begin() + 1, arguments.positionals.end(),
                     [](const std::string& word) {
                       const std::string file = word.substr(0, word.find(' '));
                       for (const char* ending : {".obj", ".ply", ".gltf", ".glb"})
                         if (file.ends_with(ending)) return true;
                       return false;
                     });
}

Exit bake_atlas(Session& session) {
  Signals signals;
  const AtlasOptions options = atlas_options(session);
  const RenderOptions& common = options.common;

  // Compile.
  const std::vector<KnobSetting> settings = knob_settings(session, common.knob_words);
  ProgramFile program = read_program(common.program, session);
  Diagnostics diagnostics, ignored;
  const lang::Program tree = lang::parse(program.sources, program.file, ignored);
  CompileOptions compile_with = compile_settings(common, settings);
  compile_with.lower.stream = surface::atlas_names();
  for (const StreamName& name : image_plane_names())
    if (name.rate == ir::Rate::frame && !name.name.starts_with("pixel"))
      compile_with.lower.stream.push_back(name);
  compile_with.lower.outputs = wanted_variables(common, tree);
  LowerHost host = module_host(program.path, session);
  Textures stored(session, program.path, common.write.working);
  stored.answer(host);
  const auto compiled = compile(program.sources, program.file, host, compile_with, diagnostics);
  report(diagnostics, program.sources, session);
  if (!compiled) return Exit::program;
  const std::vector<Knob> knobs = apply_settings(compiled->knobs, settings, session.console);
  report(stored.load(compiled->module()), program.sources, session);
  const std::vector<PlannedFile> files = plan_outputs(common, *compiled);

  // The mesh and its atlas, which may take longer than all that can be wrong above.
  const auto mesh = read_mesh(options, session);
  const auto atlas = surface::make_atlas(*mesh, options.size);
  if (!atlas) throw Failure(Exit::input, fmt::format("{}: {}", options.mesh, atlas.error()));
  if (atlas->overlaps > 0)
    session.console.warning(
        "overlap",
        fmt::format("{}: {} of {} samples belong to several triangles: the mesh's texture "
                    "coordinates overlap, and the first triangle is baked there",
                    options.mesh, atlas->overlaps, atlas->samples.size()));

  // Run, frame by frame.
  const std::vector<int> frames = common.frames.empty() ? std::vector<int>{0} : common.frames;
  Progress progress(session.console,
                    progress_style(session.arguments.text_or("progress", ""), session.console),
                    static_cast<int>(frames.size()));
  RunStatus status;
  const SignalWatch watch(signals, status);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    progress.begin_frame(static_cast<int>(f), frames[f]);
    const ImagePlane plane{.width = options.size.width,
                           .height = options.size.height,
                           .frame = double(frames[f]),
                           .fps = common.fps,
                           .seed = common.seed};
    FrameState state = plane_state(compiled->module(), plane, knobs);
    state.externals = stored.functions();
    std::vector<std::vector<float>> planes;
    const RunResult result =
        run(*compiled, state, *mesh, *atlas, common.threads, progress, status, planes);
    progress.finish();
    if (const int signal = signals.stop_signal()) return static_cast<Exit>(128 + signal);
    if (result.end == RunEnd::failed) {
      const ir::Check& check =
          compiled->module().checks[static_cast<std::size_t>(result.failed_check)];
      Diagnostics failed;
      failed.error("run-time", check.span, check.message);
      report(failed, program.sources, session);
      return Exit::running;
    }

    // Write.
    const RenderContext context{common,
                                program.sources,
                                program.file,
                                *compiled,
                                knobs,
                                plane,
                                Rect{0, 0, plane.width, plane.height},
                                stored.identities()};
    for (const PlannedFile& file : files) {
      image::ImageSpec spec;
      spec.display = spec.data = {0, 0, plane.width, plane.height};
      if (common.provenance) spec.attributes = provenance(context);
      for (const PlannedChannel& channel : file.channels) spec.channels.push_back(channel.channel);
      image::Image picture;
      picture.spec = spec;
      std::size_t bad = 0;
      for (const PlannedChannel& channel : file.channels) {
        std::vector<float> values = planes[channel.output];
        for (float& value : values)
          if (!std::isfinite(value)) ++bad, value = 0;
        picture.planes.push_back(surface::resolve(*atlas, values, options.margin));
      }
      if (bad > 0 && common.nan == image::NanPolicy::error)
        throw Failure(Exit::strict, fmt::format("{} results are NaN or infinite", bad));
      if (bad > 0)
        session.console.warning(
            "not-finite",
            fmt::format("{} results were NaN or infinite; 0 is stored there", bad));
      const std::string name = *image::frame_name(file.pattern, frames[f]);
      if (const auto done = image::write_image(name, picture, file.write); !done)
        throw Failure(Exit::output, done.error().message);
      if (name != "-") session.console.note(fmt::format("wrote {}", name));
    }
  }
  return Exit::ok;
}

}  // namespace pse::app
