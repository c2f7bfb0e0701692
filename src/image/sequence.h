// Frames and the names of their files: lists like `1-100x5,200`, patterns like `fire.%04d.exr` and
// `fire.####.exr`.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace pse::image {

// `1-100`, `1-100x5` and `1-100:5` (every fifth), `1,5,9`, `-10--1`, `10-1` (backwards), and any of
// them joined by commas. Each frame once, in the order given. The error is a sentence for the user.
std::expected<std::vector<int>, std::string> parse_frames(std::string_view text);

// Whether the name stands for one file per frame: it has `%d`, `%04d`, `####` or `#` in it. `%%` is
// a percent sign.
bool is_pattern(std::string_view name);
// The canonical form of a pattern, with `%0Nd`: a `#` alone is four digits, several are one digit
// each. The error is a sentence: two patterns in one name, or a `%` that means something else.
std::expected<std::string, std::string> canonical_pattern(std::string_view name);
// The file's name for a frame. A name without a pattern is returned as it is.
std::expected<std::string, std::string> frame_name(std::string_view pattern, int frame);

// The frames of a pattern for which files exist, sorted.
std::vector<int> existing_frames(std::string_view pattern);

}  // namespace pse::image
