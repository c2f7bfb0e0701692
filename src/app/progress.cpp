// Showing progress.
#include "app/progress.h"

#include <fmt/format.h>

#include <algorithm>

namespace pse::app {

Progress::Progress(Console& console, ProgressStyle style, int frames)
    : console_(console), style_(style), frames_(frames) {}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::begin_frame(int index, int frame) {
  index_ = index;
  frame_ = frame;
  update(0);
}

void Progress::update(double done_of_frame) {
  if (style_ != ProgressStyle::none) show((index_ + done_of_frame) / std::max(frames_, 1));
}

void Progress::show(double done) {
  const double elapsed = seconds();
  const double left = done > 0 ? elapsed * (1 - done) / done : 0;
  if (style_ == ProgressStyle::json) {
    console_.raw_error(
        fmt::format(R"({{"done": {:.4f}, "frame": {}, "elapsed": {:.3f}, "left": {:.3f}}})", done,
                    frame_, elapsed, left));
    return;
  }
  const std::string frame =
      frames_ > 1 ? fmt::format("frame {} ({} of {})  ", frame_, index_ + 1, frames_) : "";
  const std::string time = done > 0 ? fmt::format("{} left", human_seconds(left)) : "";
  if (style_ == ProgressStyle::plain) {
    // A line per tenth of the whole is enough for a log.
    const int tenth = static_cast<int>(done * 10);
    if (tenth == last_tenth_) return;
    last_tenth_ = tenth;
    console_.raw_error(fmt::format("{}{:3.0f} %  {}", frame, done * 100, time));
    return;
  }
  constexpr int width = 30;
  const auto filled = static_cast<std::size_t>(std::clamp(done, 0.0, 1.0) * width);
  console_.status_line(fmt::format("{}[{}{}] {:3.0f} %  {}", frame, std::string(filled, '='),
                                   std::string(width - filled, ' '), done * 100, time));
}

void Progress::finish() {
  if (style_ == ProgressStyle::bar) console_.status_line("");
}

ProgressStyle progress_style(const std::string& name, const Console& console) {
  if (name == "none") return ProgressStyle::none;
  if (name == "plain") return ProgressStyle::plain;
  if (name == "json") return ProgressStyle::json;
  if (name == "bar") return console.error_is_terminal() ? ProgressStyle::bar : ProgressStyle::plain;
  return console.error_is_terminal() ? ProgressStyle::bar : ProgressStyle::none;
}

}  // namespace pse::app
