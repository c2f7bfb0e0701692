// Films by the program ffmpeg, fed through a pipe: MP4 (also MOV, MKV) with H.264, yuv420p,
// converted to and tagged as bt709, playable while it still loads. The film takes its place only
// when ffmpeg has finished it.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "image/writer.h"

namespace pse::image {

struct MovieOptions {
  double frames_per_second = 24;
  ColourSpace working = ColourSpace::lin_rec709;
  Tone tone = Tone::clip;
  OcioChoice ocio;  // of Tone::ocio
  bool dither = true;
  int quality = 18;  // ffmpeg's crf: 0 is lossless, 51 the worst
  std::string program = "ffmpeg";
};

// Whether the name asks for a film: .mp4, .mov, .mkv.
bool is_movie_name(const std::string& path);

// An open film. Frames come one after the other, all with the display window of the first spec;
// each is black under its alpha. Sizes that are odd get one more row or column by repeating the
// last, since yuv420p needs even ones.
class MovieWriter {
 public:
  virtual ~MovieWriter() = default;
  // A writer for the next frame: feed it like an image's; its close() hands the frame over. One at
  // a time.
  virtual Result<std::unique_ptr<ImageWriter>> next_frame(const ImageSpec& spec) = 0;
  // Waits for ffmpeg and puts the film in its place.
  virtual Result<void> close() = 0;
};

Result<std::unique_ptr<MovieWriter>> open_movie(const std::string& path, const ImageSpec& spec,
                                                const MovieOptions& options = {});

}  // namespace pse::image
