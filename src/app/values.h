// What options' values mean: sizes, rectangles, numbers. Each throws Failure (usage) with an
// example of what is right.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/arguments.h"
#include "stream/executor.h"

namespace pse::app {

struct Resolution {
  int width = 0, height = 0;
};

// "1920x1080", "1920 1080", "512" (a square).
Resolution parse_resolution(const OptionValue& value);
// "x0,y0,x1,y1" in pixels from the top left, cut to the picture; empty rectangles are refused.
Rect parse_clip(const OptionValue& value, const Resolution& picture);
std::vector<double> parse_numbers(const OptionValue& value);
double parse_number(const OptionValue& value, double min, double max);
int parse_integer(const OptionValue& value, int min, int max);

// A number with nothing before or after it, whatever the locale.
bool read_number(std::string_view text, double& number);
std::vector<std::string> split(std::string_view text, std::string_view separators);

}  // namespace pse::app
