// Writing to the two standard streams.
#include "app/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>

namespace pse::app {
namespace {

bool wants_colour(bool terminal) {
  const char* no_colour = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  return terminal && (no_colour == nullptr || *no_colour == 0) &&
         (term == nullptr || std::string_view(term) != "dumb");
}

}  // namespace

Console::Console(std::FILE* out, std::FILE* err)
    : out_(out),
      err_(err),
      error_is_terminal_(isatty(fileno(err)) != 0),
      colour_(wants_colour(error_is_terminal_)) {}

void Console::print(std::string_view text) {
  const std::lock_guard lock(mutex_);
  std::fwrite(text.data(), 1, text.size(), out_);
}

void Console::say(std::string_view head, std::string_view colour, std::string_view line) {
  const std::lock_guard lock(mutex_);
  if (status_shown_) std::fputs("\r\033[K", err_);
  status_shown_ = false;
  std::string text;
  if (!head.empty())
    text = colour_ ? fmt::format("\033[{}m{}:\033[0m ", colour, head) : fmt::format("{}: ", head);
  text.append(line);
  text.push_back('\n');
  std::fwrite(text.data(), 1, text.size(), err_);
}

void Console::note(std::string_view line) {
  if (!quiet_) say("", "", line);
}

void Console::warning(std::string_view code, std::string_view line) {
  if (!warnings_.shows(code)) return;
  count_warning();
  {
    const std::lock_guard lock(mutex_);
    if (!said_.emplace(line).second) return;
  }
  say("warning", "1;35", fmt::format("{} [{}]", line, code));
}

void Console::error(std::string_view line, std::string_view hint) {
  say("error", "1;31", line);
  if (!hint.empty()) say("", "", fmt::format("  {}", hint));
}

void Console::raw_error(std::string_view text) {
  if (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  if (!text.empty()) say("", "", text);
}

void Console::status_line(std::string_view text) {
  const std::lock_guard lock(mutex_);
  if (text.empty() && !status_shown_) return;
  std::fputs("\r\033[K", err_);
  std::fwrite(text.data(), 1, text.size(), err_);
  std::fflush(err_);
  status_shown_ = !text.empty();
}

bool Console::flush() {
  const bool out = std::fflush(out_) == 0 && std::ferror(out_) == 0;
  std::fflush(err_);
  return out;
}

std::string human_bytes(double bytes) {
  const char* const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit < 4; ++unit) bytes /= 1024;
  return unit == 0 ? fmt::format("{:.0f} bytes", bytes)
                   : fmt::format("{:.1f} {}", bytes, units[unit]);
}

std::string human_seconds(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.0f} us", seconds * 1e6);
  if (seconds < 0.1) return fmt::format("{:.1f} ms", seconds * 1e3);
  if (seconds < 60) return fmt::format("{:.2f} s", seconds);
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace pse::app
