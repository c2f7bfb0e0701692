// Where the samples of a pixel lie: points spread evenly (spread.h) and drawn from the pixel's
// kernel (filter.h), so that all weigh the same. There are some sets of them, made once for a
// picture, and each pixel takes one by chance, so that no grid shows. The later samples of most
// sets are made when they are asked for.
#pragma once

#include <cstdint>
#include <mutex>
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

  // The first of those of pixel (x, y). May be called from several threads at once.
  Offsets of(std::int32_t x, std::int32_t y, std::size_t count) const;
  // All of one set: for what is found by counting.
  Offsets all() const { return Offsets{x_, y_}.part(0, samples_); }

 private:
  void make(std::uint32_t set, std::size_t first, std::size_t last) const;

  Filter filter_;
  std::size_t samples_;
  // Written behind the constructor only once, where nobody reads yet.
  mutable std::vector<float> x_, y_;
  mutable std::once_flag later_;
};

}  // namespace pse::antialias
