// Where the samples of a pixel lie: points spread evenly (spread.h) and drawn from the pixel's
// kernel (filter.h), so that all weigh the same. There are some sets of them, made once for a
// picture, and each pixel takes one by chance, so that no grid shows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "antialias/filter.h"

namespace pse::antialias {

// Offsets from a pixel's centre, one for each sample.
struct Offsets {
  std::span<const float> x, y;
  std::size_t size() const { return x.size(); }
  Offsets part(std::size_t first, std::size_t count) const {
    return {x.subspan(first, count), y.subspan(first, count)};
  }
};

class Patterns {
 public:
  Patterns(const Filter& filter, std::uint32_t samples);

  // Those of pixel (x, y).
  Offsets of(std::int32_t x, std::int32_t y) const;

 private:
  std::size_t samples_;
  std::vector<float> x_, y_;
};

}  // namespace pse::antialias
