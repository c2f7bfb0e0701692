// The loop over frames.
#include "app/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "app/knobs.h"
#include "app/report.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

// A tile size that gives every thread several tiles.
int choose_tile(const RenderOptions& options, const Rect& window) {
  if (options.tile > 0) return options.tile;
  int tile = 64;
  const auto tiles = [&] {
    return double(window.width()) * window.height() / (double(tile) * tile);
  };
  while (tile > 16 && tiles() < 8.0 * thread_count(options.threads)) tile /= 2;
  return tile;
}

// Memory for tiles that wait for their turn to be written.
constexpr std::size_t tile_memory = std::size_t{128} << 20;

}  // namespace

std::vector<int> choose_frames(const RenderOptions& options) {
  if (!options.frames.empty()) return options.frames;
  for (const ImageRequest& image : options.images)
    if (image::is_pattern(image.file))
      if (std::vector<int> frames = image::existing_frames(image.file); !frames.empty())
        return frames;
  return {0};
}

RenderJob::RenderJob(Session& session, const RenderOptions& options, const SourceMap& sources,
                     FileId file, antialias::Programs programs, std::vector<Knob> knobs,
                     InputImages& images, const Textures& textures, Surfaces* surfaces,
                     Signals& signals)
    : session_(session),
      options_(options),
      sources_(sources),
      file_(file),
      programs_(std::move(programs)),
      program_(programs_.shown),
      knobs_(std::move(knobs)),
      images_(images),
      textures_(textures),
      surfaces_(surfaces),
      signals_(signals),
      frames_(choose_frames(options)),
      files_(plan_outputs(options, *program_)),
      first_names_(images.names()),
      progress_(session.console,
                progress_style(session.arguments.text_or("progress", ""), session.console),
                static_cast<int>(frames_.size())),
      own_expectations_(program_->module()),
      expectations_(surfaces != nullptr ? surfaces->expectations()
                                        : std::vector{&own_expectations_}) {
  // The picture: as asked for, as the images are, or 512 x 512.
  const auto display = images_.display();
  const Resolution size = options_.resolution.value_or(
      display ? Resolution{display->width(), display->height()} : Resolution{512, 512});
  if (display && (size.width != display->width() || size.height != display->height()))
    throw Failure(Exit::input,
                  fmt::format("the picture is to have {}x{} pixels and the images have {}x{}",
                              size.width, size.height, display->width(), display->height()),
                  "leave out --res, or scale the images first");
  plane_ = {.width = size.width,
            .height = size.height,
            .fps = options_.fps,
            .seed = options_.seed,
            .transform = options_.transform};
  window_ = choose_window();
  count_operations_ = session.arguments.has("stats");
  stats_.compile = program_->times;
  stats_.threads = thread_count(options_.threads);

  // Several frames need several files.
  for (const PlannedFile& planned : files_)
    if (frames_.size() > 1 && !planned.is_film() && !image::is_pattern(planned.pattern))
      throw usage_error(
          fmt::format("{} frames would all go to `{}`", frames_.size(), planned.pattern),
          "put %04d into the name where the frame's number should stand");
}

Rect RenderJob::choose_window() const {
  if (options_.clip) return parse_clip(*options_.clip, {plane_.width, plane_.height});
  const auto display = images_.display(), data = images_.data();
  if (!display) return {0, 0, plane_.width, plane_.height};
  // Images may have pixels beyond their frame; then so has the result.
  return {data->x0 - display->x0, data->y0 - display->y0, data->x1 - display->x0,
          data->y1 - display->y0};
}

Exit RenderJob::run() {
  const SignalWatch watch(signals_, status_);
  Exit exit = Exit::ok;
  for (std::size_t i = 0; i < frames_.size() && exit == Exit::ok; ++i)
    exit = run_frame(static_cast<int>(i), frames_[i]);
  progress_.finish();
  if (exit == Exit::ok) close_films();
  stats_.tier_samples = antialias::tier_samples(programs_);
  stats_.width = program_->kernel->width();
  return exit;
}

Exit RenderJob::run_frame(int index, int frame) {
  plane_.frame = frame;
  if (index > 0 && images_.vary()) {
    images_.open(frame);
    check_channels();
    window_ = choose_window();
  }

  // What this frame is made from, and whether it is there already.
  RenderContext context{options_, sources_, file_,   *program_,
                        knobs_,   plane_,   window_, images_.identities()};
  for (const auto& texture : textures_.identities()) context.inputs.push_back(texture);
  if (surfaces_ != nullptr)
    for (const auto& file : surfaces_->identities()) context.inputs.push_back(file);
  std::vector<std::string> recipes;
  if (options_.provenance)
    for (const PlannedFile& planned : files_) recipes.push_back(recipe(context, planned));
  if (options_.resume && !status_.cancel && skip_done(frame, recipes)) return Exit::ok;

  // Open the files.
  image::ImageSpec common;
  common.display = images_.display().value_or(image::Window{0, 0, plane_.width, plane_.height});
  if (options_.write.working != image::ColourSpace::lin_rec709)
    common.chromaticities = image::chromaticities_of(options_.write.working);
  common.frames_per_second = frames_.size() > 1 ? plane_.fps : 0;
  if (options_.provenance) common.attributes = provenance(context);
  if (surfaces_ != nullptr) {
    surfaces_->begin_frame(plane_, status_);
    if (options_.trace) common.attributes.merge(surfaces_->attributes());
  }
  const TileSource pixels = images_.load(program_->module(), plane_);
  // With the apron that antialiasing looks at.
  const TileSource coordinates =
      image_plane_source(program_->module(), plane_,
                         {window_.x0 - 2, window_.y0 - 2, window_.x1 + 2, window_.y1 + 2});
  FrameWriter writer(
      files_, frame, common, window_, options_.nan, recipes,
      [this](std::size_t file, const std::string& name, const image::ImageSpec& spec) {
        return open_writer(file, name, spec);
      });

  if (index == 0 && options_.antialias.mode == antialias::Mode::supersample &&
      antialias().mode == antialias::Mode::none)
    session_.console.warning(
        "samples",
        "more samples change nothing here: the program reads stored pixels, which are known at "
        "their centres only");

  // Compute.
  progress_.begin_frame(index, frame);
  for (Expectations* expectations : expectations_) expectations->begin_frame(window_);
  if (!session_.arguments.has("quiet"))
    signals_.set_last_words(
        fmt::format("stopped at frame {}; its files are as they were\n", frame));
  TileSource seen;
  if (surfaces_ != nullptr) {
    seen = surface::at_pixel_centres(surfaces_->samples(program_->module(), plane_));
  }
  const auto source = [&](const TileView& tile) {
    seen ? seen(tile) : coordinates(tile);
    pixels(tile);
  };
  const RunResult result = compute(source, files_.empty() ? nullptr : &writer);
  stats_.compute_seconds += result.seconds;
  if (result.end == RunEnd::failed) return report_failure(result, frame), Exit::running;
  if (const int signal = signals_.stop_signal()) {
    progress_.finish();
    signals_.say_last_words();
    return static_cast<Exit>(128 + signal);
  }
  if (result.end == RunEnd::cancelled) return Exit::running;
  ++stats_.frames;
  stats_.samples += double(window_.width()) * window_.height();
  if (count_operations_ && index == 0 && surfaces_ == nullptr)
    count_run(*program_, frame_state(*program_), source, window_, status_, stats_.operations);

  // Put the files in their places.
  for (const std::string& name : writer.close())
    if (name != "-" && !image::is_movie_name(name))
      session_.console.note(fmt::format("wrote {}", name));
  signals_.set_last_words({});
  warn(writer);
  return Exit::ok;
}

bool RenderJob::skip_done(int frame, const std::vector<std::string>& recipes) const {
  for (std::size_t i = 0; i < files_.size(); ++i)
    if (files_[i].is_film() || !is_done(*image::frame_name(files_[i].pattern, frame), recipes[i]))
      return false;
  for (const PlannedFile& planned : files_)
    session_.console.note(fmt::format("kept {}", *image::frame_name(planned.pattern, frame)));
  return true;
}

FrameState RenderJob::frame_state(const Program& program) const {
  FrameState state = plane_state(program.module(), plane_, knobs_);
  if (surfaces_ != nullptr) return state;
  state.externals = textures_.functions();
  own_expectations_.bind(program.module(), state.externals);
  return state;
}

image::Result<std::unique_ptr<image::ImageWriter>> RenderJob::open_writer(
    std::size_t file, const std::string& name, const image::ImageSpec& spec) {
  const image::WriteOptions& write = files_[file].write;
  if (!files_[file].is_film()) return image::open_writer(name, spec, write);
  films_.resize(files_.size());
  if (!films_[file]) {
    image::MovieOptions movie;
    movie.frames_per_second = options_.fps;
    movie.working = write.working;
    movie.tone = write.tone;
    movie.ocio = write.ocio;
    movie.dither = write.dither;
    auto film = image::open_movie(name, spec, movie);
    if (!film) return std::unexpected(film.error());
    films_[file] = std::move(*film);
  }
  return films_[file]->next_frame(spec);
}

void RenderJob::close_films() {
  for (std::size_t i = 0; i < films_.size(); ++i) {
    if (!films_[i]) continue;
    if (const auto done = films_[i]->close(); !done)
      throw Failure(Exit::output, done.error().message);
    session_.console.note(fmt::format("wrote {}", files_[i].pattern));
  }
}

RunResult RenderJob::compute(const TileSource& source, FrameWriter* writer) {
  const auto sink = [&](const TileView& tile) {
    if (writer != nullptr) writer->add(tile);
  };
  // Called now and then, also while no tile is finished.
  const auto progress = [&](double done) {
    progress_.update(done);
    if (writer != nullptr && signals_.take_snapshot_request()) write_snapshots(*writer);
  };
  const int tile = choose_tile(options_, window_);
  const antialias::Host host{
      [this](const Program& program) { return frame_state(program); },
      [this](const ir::Module& module) {
        return surfaces_ != nullptr ? surfaces_->samples(module, plane_)
                                    : images_.anywhere(module, image_plane_samples(module, plane_));
      },
      reads_stored() ? std::optional(Rect{0, 0, plane_.width, plane_.height}) : std::nullopt};
  return antialias::execute(programs_, host, antialias(), source, sink,
                            {.window = window_,
                             .tile_width = tile,
                             .tile_height = tile,
                             .threads = options_.threads,
                             .ordered_sink = writer != nullptr,
                             .progress = progress,
                             .memory_limit = tile_memory},
                            status_, stats_.antialias);
}

// Pixels of images are known at their centres only, but for what a prepass has found.
bool RenderJob::reads_stored() const {
  if (surfaces_ != nullptr && surfaces_->is_stored()) return true;
  return std::ranges::any_of(images_.names(), [&](const StreamName& name) {
    return !(surfaces_ == nullptr && InputImages::is_span(name)) &&
           std::ranges::find(program_->reads, name.name) != program_->reads.end();
  });
}

antialias::Options RenderJob::antialias() const {
  antialias::Options antialias = options_.antialias;
  if (antialias.mode == antialias::Mode::supersample && reads_stored())
    antialias.mode = antialias::Mode::none;
  // Pixels in one row are the rows of a table, and no neighbours.
  antialias.smooth = plane_.height > 1;
  return antialias;
}

void RenderJob::write_snapshots(FrameWriter& writer) {
  try {
    const std::vector<Snapshot> snapshots = writer.write_snapshots();
    if (snapshots.empty())
      session_.console.warning("snapshot",
                               "there are no snapshots of films and of standard output");
    for (const auto& [name, step] : snapshots)
      session_.console.note(step == 1
                                ? fmt::format("wrote {}", name)
                                : fmt::format("wrote {}, 1 of {}x{} pixels", name, step, step));
  } catch (const Failure& failure) {
    session_.console.warning("snapshot", failure.what());  // the job goes on
  }
}

// A later frame's images must bring what the program was compiled for.
void RenderJob::check_channels() const {
  const std::vector<StreamName> names = images_.names();
  for (const StreamName& first : first_names_) {
    const bool read = std::find(program_->reads.begin(), program_->reads.end(), first.name) !=
                      program_->reads.end();
    const bool same = std::any_of(names.begin(), names.end(), [&](const StreamName& name) {
      return name.name == first.name && name.components == first.components;
    });
    if (read && !same)
      throw Failure(Exit::input, fmt::format("the images of frame {:.0f} have no `{}` with {} "
                                             "component{} as those of the first frame have",
                                             plane_.frame, first.name, first.components,
                                             first.components == 1 ? "" : "s"));
  }
}

void RenderJob::report_failure(const RunResult& result, int frame) {
  progress_.finish();
  const ir::Check& check = program_->module().checks[static_cast<std::size_t>(result.failed_check)];
  std::string place = result.x < 0 ? "" : fmt::format(", at pixel ({}, {})", result.x, result.y);
  if (frames_.size() > 1) place += fmt::format(" of frame {}", frame);
  Diagnostics diagnostics;
  diagnostics.error("run-time", check.span, check.message + place);
  session_.console.raw_error(print_text(diagnostics, sources_, session_.console.colour()));
}

// Of the frame that is done.
void RenderJob::warn(const FrameWriter& writer) {
  Diagnostics diagnostics;
  find_not_finite(writer, diagnostics);
  for (Expectations* expectations : expectations_) expectations->report(plane_.frame, diagnostics);
  if (!diagnostics.all().empty()) progress_.finish();
  report(diagnostics, sources_, session_);
}

void RenderJob::find_not_finite(const FrameWriter& writer, Diagnostics& diagnostics) {
  for (const NotFiniteChannel& channel : writer.not_finite()) {
    const std::string component = program_->module().outputs[channel.output].name;
    const std::string name = component.substr(0, component.find('.'));
    if (std::find(warned_.begin(), warned_.end(), name) != warned_.end()) continue;
    warned_.push_back(name);
    const auto output = std::find_if(program_->outputs.begin(), program_->outputs.end(),
                                     [&](const ProgramOutput& o) { return o.name == name; });
    const image::NotFinite& found = channel.found;
    diagnostics.warning(
        "not-finite", output == program_->outputs.end() ? Span{} : output->span,
        fmt::format(
            "`{}` is NaN at {} and infinite at {} pixels, first at ({}, {}) of frame {:.0f}", name,
            found.nan, found.infinite, found.x, found.y, plane_.frame),
        options_.nan == image::NanPolicy::keep
            ? "--nan black, box3 or error says what to do with them"
            : "");
  }
}

}  // namespace pse::app
