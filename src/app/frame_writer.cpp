// Handing tiles to the writers.
#include "app/frame_writer.h"

#include <cmath>
#include <filesystem>

#include "app/provenance.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

// What is kept in memory for snapshots: all of a picture up to the first size, of larger ones as
// many pixels as the second allows.
constexpr std::int64_t whole_snapshot_bytes = std::int64_t{128} << 20;
constexpr std::int64_t thinned_snapshot_bytes = std::int64_t{32} << 20;

std::int64_t bytes_of(const image::ImageSpec& spec) {
  return spec.data.pixels() * static_cast<std::int64_t>(spec.channels.size() * sizeof(float));
}

// The first multiple of step that is not below `at`, in steps.
int steps_to(int at, int step) {
  const int quotient = at / step;
  return quotient + (at > 0 && at % step != 0 ? 1 : 0);
}

// The places of the pixels whose coordinates are multiples of step.
image::Window thinned(const image::Window& window, int step) {
  return {steps_to(window.x0, step), steps_to(window.y0, step), steps_to(window.x1, step),
          steps_to(window.y1, step)};
}

// The step of a snapshot, 1 for all pixels.
int snapshot_step(const image::ImageSpec& spec) {
  const double bytes = static_cast<double>(bytes_of(spec));
  if (bytes <= static_cast<double>(whole_snapshot_bytes)) return 1;
  return static_cast<int>(std::ceil(std::sqrt(bytes / thinned_snapshot_bytes)));
}

// All of it is about outputs: a format that there is not, or that cannot hold this, was asked for.
[[noreturn]] void throw_failure(const image::ImageError& error) {
  // What is asked of a writer and cannot be done was asked for on the command line.
  const bool asked = error.kind == image::ErrorKind::unsupported ||
                     error.kind == image::ErrorKind::bad_request;
  throw Failure(error.kind == image::ErrorKind::not_finite ? Exit::strict
                : asked                                    ? Exit::usage
                : error.is_output()                        ? Exit::output
                                                           : Exit::input,
                error.message);
}

}  // namespace

std::string snapshot_name(const std::string& name) {
  std::filesystem::path path(name);
  const std::string extension = path.extension().string();
  return path.replace_extension(".snapshot" + extension).string();
}

FrameWriter::FrameWriter(const std::vector<PlannedFile>& files, int frame,
                         const image::ImageSpec& common, const Rect& window, image::NanPolicy nan,
                         const std::vector<std::string>& recipes, const OpenWriter& open)
    : window_(window) {
  const image::Window& display = common.display;
  data_ = {window.x0 + display.x0, window.y0 + display.y0, window.x1 + display.x0,
           window.y1 + display.y0};
  for (const PlannedFile& plan : files) {
    image::ImageSpec spec = common;
    if (!recipes.empty()) spec.attributes[recipe_attribute] = recipes[files_.size()];
    spec.data = data_;
    for (const PlannedChannel& channel : plan.channels) spec.channels.push_back(channel.channel);

    File file{.plan = &plan,
              .name = *image::frame_name(plan.pattern, frame),
              .writer = nullptr,
              .report = std::make_shared<image::NanReport>(),
              .planes = {},
              .copy = nullptr};
    auto writer = open(files_.size(), file.name, spec);
    if (!writer) throw_failure(writer.error());
    file.writer = image::with_nan_policy(std::move(*writer), nan, file.report);
    if (file.name != "-" && !plan.is_film()) {
      file.step = snapshot_step(spec);
      spec.data = thinned(spec.data, file.step);
      spec.display = thinned(spec.display, file.step);
      file.copy = std::make_unique<image::Image>(spec);
    }
    files_.push_back(std::move(file));
  }
}

void FrameWriter::add(const TileView& tile) {
  const int dx = data_.x0 - window_.x0, dy = data_.y0 - window_.y0;
  const image::Window place = {tile.rect.x0 + dx, tile.rect.y0 + dy, tile.rect.x1 + dx,
                               tile.rect.y1 + dy};
  for (File& file : files_) {
    file.planes.clear();
    for (const PlannedChannel& channel : file.plan->channels)
      file.planes.push_back(tile.planes[channel.output]);
    if (const auto done = file.writer->write_tile(place, file.planes); !done)
      throw_failure(done.error());

    if (!file.copy) continue;
    const std::lock_guard lock(copying_);
    keep(file, place);
  }
}

// Copies what a snapshot shows of the tile at `place`.
void FrameWriter::keep(File& file, const image::Window& place) {
  image::Image& copy = *file.copy;
  const image::Window kept = thinned(place, file.step), &whole = copy.spec.data;
  for (std::size_t c = 0; c < file.planes.size(); ++c)
    for (int y = kept.y0; y < kept.y1; ++y) {
      const float* from = file.planes[c] + std::int64_t{y * file.step - place.y0} * place.width();
      float* to = copy.planes[c].data() + std::int64_t{y - whole.y0} * whole.width();
      for (int x = kept.x0; x < kept.x1; ++x) to[x - whole.x0] = from[x * file.step - place.x0];
    }
}

std::vector<Snapshot> FrameWriter::write_snapshots() {
  std::vector<Snapshot> snapshots;
  const std::lock_guard lock(copying_);
  for (const File& file : files_) {
    if (!file.copy) continue;
    snapshots.push_back({snapshot_name(file.name), file.step});
    if (const auto done = image::write_image(snapshots.back().name, *file.copy, file.plan->write);
        !done)
      throw_failure(done.error());
  }
  return snapshots;
}

std::vector<std::string> FrameWriter::close() {
  std::vector<std::string> names;
  for (File& file : files_) {
    if (const auto done = file.writer->close(); !done) throw_failure(done.error());
    names.push_back(file.name);
  }
  return names;
}

std::vector<NotFiniteChannel> FrameWriter::not_finite() const {
  std::vector<NotFiniteChannel> found;
  for (const File& file : files_)
    for (std::size_t c = 0; c < file.report->size(); ++c)
      if ((*file.report)[c].count() > 0)
        found.push_back({file.plan->channels[c].output, (*file.report)[c]});
  return found;
}

}  // namespace pse::app
