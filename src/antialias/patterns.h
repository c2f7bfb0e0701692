// Where the samples of a pixel lie: points spread evenly (spread.h) and drawn from the pixel's
// kernel (filter.h), so that all weigh the same. There are some sets of them, made once for a
// picture, and each pixel takes one by chance, so that no grid shows.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "antialias/filter.h"

namespace pse::antialias {

class Patterns {
 public:
  Patterns(const Filter& filter, std::uint32_t samples);

  // Offsets from the centre of pixel (x, y): one for each sample.
  std::span<const std::array<float, 2>> of(std::int32_t x, std::int32_t y) const;

 private:
  std::uint32_t samples_;
  std::vector<std::array<float, 2>> offsets_;
};

}  // namespace pse::antialias
