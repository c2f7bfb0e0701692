// Inserting a data base into an image: each row of a table is spread over the pixels around its
// place, by a small kernel, so that nothing aliases and nothing gets lost wherever between pixels
// it falls. 1985 paper, "Now What?".
//
// The kernel is the cubic B-spline with knots a pixel apart (or `size` pixels, where a row has
// one), along x and along y. Its values at the pixels' centres add up to 1.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/error.h"
#include "image/image.h"

namespace pse::image {

// How the rows that reach a pixel become the pixel's value.
enum class Rule {
  sum,      // each adds its share: the pixels of a row add up to its value
  max,      // the largest share, the kernel's middle being 1
  mean,     // the mean, weighed by the kernel; 0 where no row reaches
  nearest,  // that of the row nearest to the eye whose kernel's inner part covers the centre
};
std::optional<Rule> rule_from_name(std::string_view name);

// Where a row belongs, in pixels from the upper left corner of the picture; centres lie at .5.
struct Place {
  double x = 0, y = 0;
  double distance = 0;  // from the eye, in any unit; for Rule::nearest
  double size = 1;      // of its kernel, in pixels; below 1 counts as 1
};

struct SplatColumn {
  std::span<const float> values;  // one per row
  Rule rule = Rule::sum;
};

struct Splatted {
  std::vector<std::vector<float>> planes;  // one per column: width * height, row by row
  std::vector<float> coverage;             // what a column of ones under Rule::sum becomes
};

// Rows outside the picture, as far as their kernels lie outside, are left out.
Splatted splat(std::span<const Place> places, std::span<const SplatColumn> columns, int width,
               int height);

}  // namespace pse::image
