// Two edges under one kernel: they part it into up to four regions, and samples of each region tell
// its value. The kernel's weight of a region is known far better than a share of the samples: for
// each edge alone it is exact (filter.h). 2002 chapter, "More Detailed Description", where such
// pixels go to supersampling at once.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "antialias/derive.h"
#include "antialias/filter.h"
#include "antialias/patterns.h"

namespace pse::antialias {

struct Lines {
  Line first{no_edge, 1, 0}, second{no_edge, 1, 0};  // as seen from the pixel's centre
  bool are_within(float reach) const {
    return std::abs(first.distance) < reach && std::abs(second.distance) < reach;
  }
};

class Corner {
 public:
  explicit Corner(const Lines& lines) : lines_(lines) {}

  // The places in each region, of up to 32: bit k is place k. Those that are so near to a line that
  // they may lie beyond it stand apart.
  struct Regions {
    std::array<std::uint32_t, 4> sure, unsure;
  };
  Regions regions(const Offsets& offsets) const;

  // The kernel's weights of the regions. `offsets`: places that follow the kernel.
  std::array<float, 4> weights(const Filter& filter, const Offsets& offsets) const;

 private:
  Lines lines_;
};

}  // namespace pse::antialias
