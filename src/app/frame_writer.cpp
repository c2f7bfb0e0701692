// Handing tiles to the writers.
#include "app/frame_writer.h"

#include <algorithm>
#include <filesystem>

#include "app/provenance.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

// Pictures with more than this are not kept in memory for snapshots.
constexpr std::int64_t most_snapshot_bytes = std::int64_t{128} << 20;

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

    File file{&plan,   *image::frame_name(plan.pattern, frame),
              nullptr, std::make_shared<image::NanReport>(),
              nullptr, {}};
    auto writer = open(files_.size(), file.name, spec);
    if (!writer) throw_failure(writer.error());
    file.writer = image::with_nan_policy(std::move(*writer), nan, file.report);
    const std::int64_t bytes =
        data_.pixels() * static_cast<std::int64_t>(spec.channels.size() * sizeof(float));
    if (bytes <= most_snapshot_bytes && file.name != "-" && !plan.is_film())
      file.copy = std::make_unique<image::Image>(spec);
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

    // Keep a copy for snapshots.
    if (!file.copy) continue;
    const std::lock_guard lock(copying_);
    for (std::size_t c = 0; c < file.planes.size(); ++c)
      for (int row = 0; row < tile.rect.height(); ++row)
        std::copy_n(file.planes[c] + std::ptrdiff_t{row} * tile.rect.width(), tile.rect.width(),
                    file.copy->planes[c].begin() +
                        std::int64_t{tile.rect.y0 + row - window_.y0} * window_.width() +
                        (tile.rect.x0 - window_.x0));
  }
}

std::vector<std::string> FrameWriter::write_snapshots() {
  std::vector<std::string> names;
  const std::lock_guard lock(copying_);
  for (const File& file : files_) {
    if (!file.copy) continue;
    names.push_back(snapshot_name(file.name));
    if (const auto done = image::write_image(names.back(), *file.copy, file.plan->write); !done)
      throw_failure(done.error());
  }
  return names;
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
