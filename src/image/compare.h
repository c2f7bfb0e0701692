// Telling about images and comparing two of them: what `pse info` and `pse diff` show.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "image/reader.h"

namespace pse::image {

// Lines of a heading and what it says: windows, channels, layers, attributes. Long texts are kept
// whole.
std::vector<std::pair<std::string, std::string>> describe(const ImageSpec& spec);

struct ChannelDifference {
  std::string name;
  double largest = 0;      // of |a - b|; infinite where only one of the two is finite
  double rms = 0;          // over the places where both are finite
  int x = 0, y = 0;        // where the largest is
  std::int64_t above = 0;  // places with |a - b| > tolerance
};

struct Comparison {
  std::vector<std::string> shape;           // sentences: other windows, channels that only one has
  std::vector<ChannelDifference> channels;  // those that both have
  bool same() const;                        // same shape, and nothing above the tolerance
};

// NaN equals NaN, an infinity equals itself. Pixels outside a data window count as 0.
Result<Comparison> compare(ImageReader& a, ImageReader& b, double tolerance);

}  // namespace pse::image
