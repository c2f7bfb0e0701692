// Frames and file names; see sequence.h.
#include "image/sequence.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>

namespace pse::image {
namespace {

constexpr std::size_t most_frames = 1'000'000;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())))
    text.remove_prefix(1);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())))
    text.remove_suffix(1);
  return text;
}

// Takes a number off the front of `text`.
std::optional<int> take_number(std::string_view& text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

// One item of a list: a frame, or from-to with a step.
struct Range {
  int from = 0, to = 0, step = 1;
};

std::optional<Range> parse_range(std::string_view text) {
  Range range;
  const auto from = take_number(text);
  if (!from) return std::nullopt;
  range.from = range.to = *from;
  if (text.empty()) return range;
  if (text.front() != '-') return std::nullopt;
  text.remove_prefix(1);
  const auto to = take_number(text);
  if (!to) return std::nullopt;
  range.to = *to;
  if (text.empty()) return range;
  if (text.front() != 'x' && text.front() != ':') return std::nullopt;
  text.remove_prefix(1);
  const auto step = take_number(text);
  if (!step || *step < 1 || !text.empty()) return std::nullopt;
  range.step = *step;
  return range;
}

// Where the pattern lies in a name and how many digits it asks for.
struct Pattern {
  std::size_t begin = 0, end = 0;
  int digits = 1;
};

// The error is a sentence; no value means there is no pattern.
std::expected<std::optional<Pattern>, std::string> find_pattern(std::string_view name) {
  std::optional<Pattern> found;
  for (std::size_t i = 0; i < name.size();) {
    Pattern here{i, i, 1};
    if (name[i] == '#') {
      while (here.end < name.size() && name[here.end] == '#') ++here.end;
      here.digits = here.end - here.begin == 1 ? 4 : static_cast<int>(here.end - here.begin);
    } else if (name[i] == '%') {
      std::string_view rest = name.substr(i + 1);
      if (rest.starts_with('%')) {
        i += 2;
        continue;
      }
      const bool zero = rest.starts_with('0');
      if (zero) here.digits = take_number(rest).value_or(1);
      if (!rest.starts_with('d') || here.digits < 0)
        return std::unexpected(
            "in \"" + std::string(name) +
            "\" the % is no frame number; write %04d for one, %% for a percent sign");
      here.end = name.size() - rest.size() + 1;
    } else {
      ++i;
      continue;
    }
    if (found)
      return std::unexpected("\"" + std::string(name) + "\" has two places for the frame number");
    if (here.digits > 32)
      return std::unexpected("\"" + std::string(name) + "\" asks for more digits than a frame has");
    found = here;
    i = here.end;
  }
  return found;
}

// `%%` outside the pattern is a percent sign.
std::string unescaped(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    if (text[i] == '%' && i + 1 < text.size() && text[i + 1] == '%') ++i;
  }
  return out;
}

std::string padded(int frame, int digits) {
  std::string text = std::to_string(std::abs(std::int64_t{frame}));
  const int sign = frame < 0 ? 1 : 0;
  const int missing = digits - sign - static_cast<int>(text.size());
  if (missing > 0) text.insert(0, static_cast<std::size_t>(missing), '0');
  return (sign == 1 ? "-" : "") + text;
}

}  // namespace

std::expected<std::vector<int>, std::string> parse_frames(std::string_view text) {
  const auto wrong = [&](std::string_view item) {
    return std::unexpected("\"" + std::string(item) +
                           "\" is no list of frames");
  };
  std::vector<int> frames;
  std::set<int> seen;
  std::string_view rest = trimmed(text);
  for (bool more = true; more;) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view item = trimmed(rest.substr(0, comma));
    if (more) rest.remove_prefix(comma + 1);
    const auto range = parse_range(item);
    if (!range) return wrong(item.empty() ? text : item);

    const std::int64_t way = range->to < range->from ? -1 : 1;
    const std::int64_t count = (std::int64_t{range->to} - range->from) * way / range->step + 1;
    if (count + static_cast<std::int64_t>(frames.size()) > static_cast<std::int64_t>(most_frames))
      return std::unexpected("\"" + std::string(text) + "\" is more than a million frames");
    for (std::int64_t i = 0; i < count; ++i) {
      const int frame = static_cast<int>(range->from + way * i * range->step);
      if (seen.insert(frame).second) frames.push_back(frame);
    }
  }
  return frames;
}

bool is_pattern(std::string_view name) {
  const auto place = find_pattern(name);
  return place && place->has_value();
}

std::expected<std::string, std::string> canonical_pattern(std::string_view name) {
  const auto place = find_pattern(name);
  if (!place) return std::unexpected(place.error());
  if (!*place) return std::string(name);
  const int digits = (*place)->digits;
  const std::string format = digits <= 1 ? "%d" : "%0" + std::to_string(digits) + "d";
  return std::string(name.substr(0, (*place)->begin)) + format +
         std::string(name.substr((*place)->end));
}

std::expected<std::string, std::string> frame_name(std::string_view pattern, int frame) {
  const auto place = find_pattern(pattern);
  if (!place) return std::unexpected(place.error());
  if (!*place) return unescaped(pattern);
  return unescaped(pattern.substr(0, (*place)->begin)) + padded(frame, (*place)->digits) +
         unescaped(pattern.substr((*place)->end));
}

std::vector<int> existing_frames(std::string_view pattern) {
  const auto place = find_pattern(pattern);
  if (!place || !*place) return {};
  // Only the last part of the path may vary.
  const auto slash = pattern.rfind('/');
  if (slash != std::string_view::npos && slash > (*place)->begin) return {};
  const std::size_t start = slash == std::string_view::npos ? 0 : slash + 1;
  const std::string folder = slash == std::string_view::npos
                                 ? "."
                                 : unescaped(pattern.substr(0, std::max<std::size_t>(slash, 1)));
  const std::string head = unescaped(pattern.substr(start, (*place)->begin - start));
  const std::string tail = unescaped(pattern.substr((*place)->end));

  std::vector<int> frames;
  std::error_code problem;
  for (std::filesystem::directory_iterator at(folder, problem), end; !problem && at != end;
       at.increment(problem)) {
    const std::string name = at->path().filename().string();
    if (name.size() <= head.size() + tail.size() || !name.starts_with(head) ||
        !name.ends_with(tail))
      continue;
    std::string_view digits(name);
    digits = digits.substr(head.size(), name.size() - head.size() - tail.size());
    std::string_view rest = digits;
    const auto frame = take_number(rest);
    if (frame && rest.empty() && padded(*frame, (*place)->digits) == digits)
      frames.push_back(*frame);
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

}  // namespace pse::image
