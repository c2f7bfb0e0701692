// The loop over frames of a volume.
#include "app/bake_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "app/knobs.h"
#include "app/report.h"
#include "base/hash.h"
#include "image/output_file.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

// A UUID's place in the file takes 36 characters.
std::string identity_of(const std::string& recipe) {
  std::string text = recipe;
  for (const std::size_t at : {8, 13, 18, 23}) text.insert(at, "-");
  return text;
}

volume::GridKind kind_of(const std::string& name) {
  if (name == "distance") return volume::GridKind::level_set;
  return volume::GridKind::fog;
}

}  // namespace

void write_grids(volume::GridWriter& writer, const std::string& name,
                 std::map<std::string, std::string> attributes, const std::string& recipe,
                 bool provenance) {
  if (provenance)
    attributes[recipe_attribute] = recipe;
  else
    attributes.clear();
  auto file = image::OutputFile::create(name);
  if (!file) throw Failure(Exit::output, file.error().message);
  if (const auto written = writer.write(file->path_for_others(), attributes, identity_of(recipe));
      !written) {
    // Whether there was room is asked of the disk: OpenVDB's errors do not say it.
    std::error_code unknown;
    const auto space = std::filesystem::space(file->path_for_others(), unknown);
    if (!unknown && space.available < (std::uintmax_t{1} << 20))
      throw Failure(Exit::output,
                    fmt::format("no room to write {}; what was there before is unchanged", name),
                    "lower --res, or write to another disk");
    throw Failure(Exit::output, fmt::format("cannot write {}: {}", name, written.error().message));
  }
  if (const auto done = file->commit(); !done) throw Failure(Exit::output, done.error().message);
}

bool is_baked(volume::Vdb& vdb, const std::string& name, const std::string& recipe) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(name, error)) return false;
  const auto info = vdb.info(name);
  if (!info) return false;
  const auto found = info->attributes.find(recipe_attribute);
  return found != info->attributes.end() && found->second == recipe;
}

BakeJob::BakeJob(Session& session, const VolumeOptions& options, const SourceMap& sources,
                 FileId file, std::shared_ptr<const Program> program, std::vector<Knob> knobs,
                 const Textures& inputs, Signals& signals)
    : session_(session),
      options_(options),
      sources_(sources),
      file_(file),
      program_(std::move(program)),
      knobs_(std::move(knobs)),
      inputs_(inputs),
      signals_(signals),
      lattice_(options.bounds.value_or(volume::Box{}), options.size, options.z_up),
      frames_(options.common.frames.empty() ? std::vector<int>{0} : options.common.frames),
      progress_(session.console,
                progress_style(session.arguments.text_or("progress", ""), session.console),
                static_cast<int>(frames_.size())) {
  const auto vdb = volume::open_vdb();
  if (!vdb) throw Failure(Exit::output, vdb.error().message);
  vdb_ = *vdb;
  if (frames_.size() > 1 && !image::is_pattern(options_.common.outputs.front().file))
    throw usage_error(fmt::format("{} frames would all go to `{}`", frames_.size(),
                                  options_.common.outputs.front().file),
                      "put %04d into the name where the frame's number should stand");
  for (const ProgramOutput& output : program_->outputs) grids_.push_back(plan_grid(output));
}

volume::BakedGrid BakeJob::plan_grid(const ProgramOutput& output) const {
  volume::BakedGrid grid;
  grid.spec.name = output.name;
  grid.spec.kind = kind_of(output.name);
  grid.spec.half = options_.half;
  grid.spec.components = output.components == 1 ? 1 : 3;
  // A colour's fourth component is its alpha, which a volume has as density.
  if (output.components != 1 && output.components != 3 && output.components != 4)
    throw Failure(Exit::program,
                  fmt::format("`{}` has {} components; a grid holds numbers or vectors of three",
                              output.name, output.components));
  if (grid.spec.kind == volume::GridKind::level_set) {
    if (output.components != 1)
      throw Failure(Exit::program, fmt::format("`{}` is a number, not a vector", output.name));
    const auto& voxel = lattice_.voxel();
    grid.band = options_.band * static_cast<float>(std::max({voxel[0], voxel[1], voxel[2]}));
    grid.spec.background = grid.band;
  }
  const auto& outputs = program_->module().outputs;
  for (int c = 0; c < grid.spec.components; ++c) {
    const std::string name =
        output.components == 1 ? output.name : fmt::format("{}.{}", output.name, c);
    const auto found = std::find_if(outputs.begin(), outputs.end(),
                                    [&](const ir::Output& o) { return o.name == name; });
    grid.outputs.push_back(static_cast<std::size_t>(found - outputs.begin()));
  }
  return grid;
}

Exit BakeJob::run() {
  const SignalWatch watch(signals_, status_);
  Exit exit = Exit::ok;
  for (std::size_t i = 0; i < frames_.size() && exit == Exit::ok; ++i)
    exit = run_frame(static_cast<int>(i), frames_[i]);
  progress_.finish();
  return exit;
}

Exit BakeJob::run_frame(int index, int frame) {
  const RenderOptions& common = options_.common;
  const std::string name = *image::frame_name(common.outputs.front().file, frame);

  // What this frame is made from, and whether it is there already.
  const ImagePlane plane{.width = lattice_.size()[0],
                         .height = lattice_.size()[1],
                         .frame = double(frame),
                         .fps = common.fps,
                         .seed = common.seed};
  const Rect window{0, 0, plane.width, plane.height};
  const RenderContext context{common, sources_, file_,  *program_,
                              knobs_, plane,    window, inputs_.identities()};
  Hasher hasher;
  hasher.add(recipe(context, PlannedFile{}));
  for (std::size_t a = 0; a < 3; ++a) {
    hasher.add(lattice_.size()[a]);
    hasher.add(fmt::format("{} {}", lattice_.origin()[a], lattice_.voxel()[a]));
  }
  for (const volume::BakedGrid& grid : grids_) {
    hasher.add(fmt::format("{} {} {}", grid.spec.name, grid.spec.half, grid.band));
  }
  hasher.add(options_.z_up);
  const std::string made_by = hasher.finish().text();
  if (common.resume && is_baked(*vdb_, name, made_by)) {
    session_.console.note(fmt::format("kept {}", name));
    return Exit::ok;
  }

  // Run.
  progress_.begin_frame(index, frame);
  if (!session_.arguments.has("quiet"))
    signals_.set_last_words(fmt::format("stopped at frame {}; its file is as it was\n", frame));
  FrameState state;
  volume::set_lattice_uniforms(program_->module(), lattice_,
                               {double(frame), common.fps, common.seed}, state);
  set_knob_uniforms(program_->module(), knobs_, state);
  state.externals = inputs_.functions();
  std::vector<volume::GridSpec> specs;
  for (const volume::BakedGrid& grid : grids_) specs.push_back(grid.spec);
  const auto writer = vdb_->writer(specs, {lattice_.origin(), lattice_.voxel()});
  volume::BakeOptions bake;
  bake.threads = common.threads;
  bake.memory_limit = options_.memory_limit;
  bake.stop_at_not_finite = common.nan == image::NanPolicy::error;
  bake.progress = [this](double done) { progress_.update(done); };
  const volume::BakeResult result =
      volume::bake(*program_, state, lattice_, grids_, *writer, bake, status_);
  if (result.end == RunEnd::failed) return report_failure(result), Exit::running;
  if (result.out_of_memory)
    throw Failure(
        Exit::running,
        fmt::format("the volume {} more than {}; nothing was written",
                    result.estimate > 0 ? fmt::format("would take about {} of memory,",
                                                      human_bytes(result.estimate))
                                        : "takes",
                    human_bytes(double(options_.memory_limit))),
        "lower --res, or raise --memory");
  if (result.not_finite > 0 && bake.stop_at_not_finite) {
    report_result(result, name);
    throw Failure(Exit::strict, fmt::format("{} was not written", name));
  }
  if (const int signal = signals_.stop_signal()) {
    progress_.finish();
    signals_.say_last_words();
    return static_cast<Exit>(128 + signal);
  }
  if (result.end == RunEnd::cancelled) return Exit::running;

  // Write.
  std::map<std::string, std::string> attributes = provenance(context);
  attributes["pse/up"] = options_.z_up ? "z" : "y";
  attributes["pse/units"] = "metres";
  write_grids(*writer, name, attributes, made_by, common.provenance);
  signals_.set_last_words({});
  report_result(result, name);
  return Exit::ok;
}

void BakeJob::report_failure(const volume::BakeResult& result) {
  progress_.finish();
  const ir::Check& check = program_->module().checks[static_cast<std::size_t>(result.failed_check)];
  Diagnostics diagnostics;
  diagnostics.error("run-time", check.span,
                    fmt::format("{}, at point [{:g} {:g} {:g}]", check.message, result.failed_at[0],
                                result.failed_at[1], result.failed_at[2]));
  session_.console.raw_error(print_text(diagnostics, sources_, session_.console.colour()));
}

void BakeJob::report_result(const volume::BakeResult& result, const std::string& name) {
  progress_.finish();
  const auto& size = lattice_.size();
  if (result.not_finite > 0) {
    const std::string& grid = grids_[result.not_finite_grid].spec.name;
    const auto output = std::find_if(program_->outputs.begin(), program_->outputs.end(),
                                     [&](const ProgramOutput& o) { return o.name == grid; });
    Diagnostics diagnostics;
    diagnostics.warning("not-finite", output->span,
                        fmt::format("{} values are NaN or infinite and stored as nothing, first "
                                    "`{}` at point [{:g} {:g} {:g}]",
                                    result.not_finite, grid, result.not_finite_at[0],
                                    result.not_finite_at[1], result.not_finite_at[2]));
    show(diagnostics, sources_, session_.console);
  }
  if (result.not_finite > 0 && options_.common.nan == image::NanPolicy::error) return;
  if (result.active == 0)
    session_.console.warning(
        "empty",
        fmt::format("{} is empty: no voxel's centre lies in matter; --bounds moves the box, and "
                    "what is thinner than a voxel ({:.3g} m) wants a higher --res",
                    name, *std::max_element(lattice_.voxel().begin(), lattice_.voxel().end())));
  else if (result.cut)
    session_.console.warning("cut", fmt::format(
        "{}: matter reaches the side of the box and is cut; --bounds makes it larger", name));
  session_.console.note(fmt::format("wrote {}: {}x{}x{} voxels, {:.1f} % with matter", name,
                                    size[0], size[1], size[2],
                                    100.0 * double(result.active) / double(lattice_.voxels())));
}

}  // namespace pse::app
