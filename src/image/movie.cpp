// Films through ffmpeg; see movie.h.
#include "image/movie.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "image/child.h"
#include "image/display.h"
#include "image/framed.h"
#include "image/output_file.h"

namespace pse::image {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end.ptr);
}

class Movie : public MovieWriter {
 public:
  Movie(OutputFile file, Child child, const Window& size, const MovieOptions& options)
      : file_(std::move(file)), child_(std::move(child)), size_(size), options_(options) {}

  Result<std::unique_ptr<ImageWriter>> next_frame(const ImageSpec& spec) override;
  Result<void> close() override;

 private:
  friend class Frame;
  ImageError complain() {
    child_.finish();
    const std::string said = child_.complaint();
    const bool full =
        said.find("No space") != std::string::npos || said.find("too large") != std::string::npos;
    return {full ? ErrorKind::disk_full : ErrorKind::cannot_write,
            "ffmpeg did not write " + file_.name() + (said.empty() ? "" : ": " + said)};
  }

  OutputFile file_;
  Child child_;
  Window size_;
  MovieOptions options_;
};

// One frame: rows are turned into bytes for display and go into the pipe.
class Frame : public ImageWriter {
 public:
  Frame(const ImageSpec& spec, Movie& movie, DisplayTransform transform)
      : ImageWriter(spec, movie.file_.name()), movie_(movie), transform_(std::move(transform)) {
    const auto width = static_cast<std::size_t>(spec.data.width());
    display_.resize(width * static_cast<std::size_t>(transform_.channels().count()));
    bytes_.resize(width * 3);
  }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    std::vector<const float*> row(planes.begin(), planes.end());
    const std::size_t values = transform_.channels().values.size();
    const bool spread = movie_.options_.dither && transform_.channels().colour;
    for (int i = 0; i < count; ++i) {
      transform_.row(row, spec_.data.width(), true, display_.data());
      for (std::size_t p = 0; p < bytes_.size(); ++p) {
        const float threshold = spread ? dither(static_cast<int>(p / 3), y + i) : 0.5f;
        bytes_[p] = to_8_bits(display_[p / 3 * values + std::min(p % 3, values - 1)], threshold);
      }
      if (!movie_.child_.feed(bytes_)) return std::unexpected(movie_.complain());
      for (auto& plane : row) plane += stride;
    }
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  Movie& movie_;
  DisplayTransform transform_;
  std::vector<float> display_;
  std::vector<unsigned char> bytes_;
};

Result<std::unique_ptr<ImageWriter>> Movie::next_frame(const ImageSpec& spec) {
  if (spec.display.width() != size_.width() || spec.display.height() != size_.height())
    return fail(ErrorKind::bad_request, "the frames of " + file_.name() + " have different sizes");
  auto chosen = pick_display_channels(spec, file_.name());
  if (!chosen) return std::unexpected(chosen.error());
  chosen->alpha = -1;
  ImageSpec framed = spec;
  framed.data = framed.display = {0, 0, size_.width(), size_.height()};
  auto transform = DisplayTransform::create(std::move(*chosen), options_.working, options_.tone,
                                            options_.ocio);
  if (!transform) return std::unexpected(transform.error());
  auto frame = std::make_unique<Frame>(framed, *this, std::move(*transform));
  if (spec.data == spec.display) return frame;
  return put_in_frame(std::move(frame), spec);
}

Result<void> Movie::close() {
  if (!child_.finish()) return std::unexpected(complain());
  return file_.commit();
}

}  // namespace

bool is_movie_name(const std::string& path) {
  const std::string ending = format_of_name(path);
  return ending == "mp4" || ending == "mov" || ending == "mkv";
}

Result<std::unique_ptr<MovieWriter>> open_movie(const std::string& path, const ImageSpec& spec,
                                                const MovieOptions& options) {
  const int width = spec.display.width(), height = spec.display.height();
  if (width < 1 || height < 1 || width > 16384 || height > 16384)
    return fail(ErrorKind::bad_request, "a film has frames of 1 to 16384 pixels a side");
  if (!(options.frames_per_second > 0 && options.frames_per_second <= 1000))
    return fail(ErrorKind::bad_request, "a film has between 0 and 1000 frames per second");
  auto file = OutputFile::create(path);
  if (!file) return std::unexpected(file.error());
  const std::string ending = format_of_name(path);
  const std::string container = ending == "mkv" ? "matroska" : ending == "mov" ? "mov" : "mp4";

  // ffmpeg converts to bt709 itself and must be told what the numbers mean on both sides.
  const std::vector<std::string> words = {
      options.program,
      "-nostdin",
      "-y",
      "-loglevel",
      "error",
      "-f",
      "rawvideo",
      "-pix_fmt",
      "rgb24",
      "-video_size",
      std::to_string(width) + "x" + std::to_string(height),
      "-framerate",
      number(options.frames_per_second),
      "-i",
      "pipe:0",
      "-vf",
      "pad=ceil(iw/2)*2:ceil(ih/2)*2,fillborders=right=" + std::to_string(width % 2) +
          ":bottom=" + std::to_string(height % 2) +
          ":mode=smear,scale=in_range=pc:out_range=tv:out_color_matrix=bt709:flags=accurate_rnd",
      "-c:v",
      "libx264",
      "-crf",
      std::to_string(options.quality),
      "-pix_fmt",
      "yuv420p",
      "-color_range",
      "tv",
      "-colorspace",
      "bt709",
      "-color_primaries",
      "bt709",
      "-color_trc",
      "bt709",
      "-fflags",
      "+bitexact",
      "-flags:v",
      "+bitexact",
      "-movflags",
      "+faststart",
      "-f",
      container,
      file->path_for_others()};
  auto child = Child::start(words);
  if (!child)
    return fail(ErrorKind::cannot_write,
                "cannot write the film " + path + ": " + child.error().message);
  return std::make_unique<Movie>(std::move(*file), std::move(*child), spec.display, options);
}

}  // namespace pse::image
