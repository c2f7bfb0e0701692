// Reading numbers out of options' texts.
#include "app/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/failure.h"

namespace pse::app {
namespace {

constexpr int largest_side = 1 << 18;

[[noreturn]] void refuse(const OptionValue& value, std::string_view what,
                         std::string_view example) {
  throw usage_error(fmt::format("{} takes {}, not `{}`", value.origin, what, value.text),
                    fmt::format("for example: {}", example));
}

}  // namespace

std::vector<std::string> split(std::string_view text, std::string_view separators) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(separators), text.size());
    if (end > 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  return parts;
}

bool read_number(std::string_view text, double& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

std::vector<double> parse_numbers(const OptionValue& value) {
  std::vector<double> numbers;
  for (const std::string& part : split(value.text, ", \t\n[]()")) {
    numbers.push_back(0);
    if (!read_number(part, numbers.back()) || !std::isfinite(numbers.back()))
      throw usage_error(fmt::format("{}: `{}` is not a number", value.origin, part));
  }
  return numbers;
}

Resolution parse_resolution(const OptionValue& value) {
  const std::vector<std::string> parts = split(value.text, "xX, ");
  Resolution size;
  const auto side = [&](const std::string& text) {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || number < 1)
      refuse(value, "a size in pixels", "--res 1920x1080");
    if (number > largest_side)
      throw usage_error(fmt::format("{}: {} pixels is more than the {} that a side may have",
                                    value.origin, number, largest_side));
    return number;
  };
  // One side stands for both, unless the other was begun.
  const bool begun = value.text.find_first_of("xX,") != std::string::npos;
  if (parts.empty() || parts.size() > 2 || (begun && parts.size() == 1))
    refuse(value, "a size in pixels", "--res 1920x1080");
  size.width = side(parts.front());
  size.height = side(parts.back());
  return size;
}

Rect parse_clip(const OptionValue& value, const Resolution& picture) {
  const std::vector<double> n = parse_numbers(value);
  const bool whole = std::all_of(n.begin(), n.end(),
                                 [](double v) { return v == std::floor(v) && std::abs(v) < 1e9; });
  if (n.size() != 4 || !whole) refuse(value, "four whole numbers of pixels", "--clip 0,0,256,256");
  const Rect clip = {std::max(static_cast<int>(n[0]), 0), std::max(static_cast<int>(n[1]), 0),
                     std::min(static_cast<int>(n[2]), picture.width),
                     std::min(static_cast<int>(n[3]), picture.height)};
  if (clip.width() <= 0 || clip.height() <= 0)
    throw usage_error(fmt::format("{} leaves no pixel of the {}x{} picture: `{}`", value.origin,
                                  picture.width, picture.height, value.text),
                      "its numbers are x0,y0,x1,y1, from the top left, with x1 and y1 excluded");
  return clip;
}

double parse_number(const OptionValue& value, double min, double max) {
  double number = 0;
  if (!read_number(value.text, number) || !(number >= min && number <= max))
    throw usage_error(fmt::format("{} takes a number from {} to {}, not `{}`", value.origin, min,
                                  max, value.text));
  return number;
}

int parse_integer(const OptionValue& value, int min, int max) {
  double number = 0;
  if (!read_number(value.text, number) || number != std::floor(number) ||
      !(number >= min && number <= max))
    throw usage_error(fmt::format("{} takes a whole number from {} to {}, not `{}`", value.origin,
                                  min, max, value.text));
  return static_cast<int>(number);
}

}  // namespace pse::app
