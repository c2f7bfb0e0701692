// The mean over a pixel of what changes within it but has no edge there, from samples half a pixel
// apart: those in the pixel's middle and in its neighbours' are there already, those on its sides
// and corners are its neighbours' too. Where all pixels of a region want them that is three samples
// more for each. It stands between the nine samples of smooth.h and the patterns of patterns.h,
// which what is finer still needs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "antialias/filter.h"
#include "antialias/tile.h"

namespace pse::antialias {

// What a sample counts in the mean: the one in the middle, each of the four half a pixel along the
// rows or columns, each of the four at the corners, and each of the four in the next pixels'
// middles.
struct HalfWeights {
  float middle = 0, side = 0, corner = 0, next = 0;
};

// Exact for polynomials of the third degree. With the next pixels also right for waves of
// `true_wave` pixels along the rows and along the diagonals, without them along the mean of both.
// Nothing for kernels that reach beyond the pixel.
struct HalfMeans {
  HalfWeights with_next, alone;
};
std::optional<HalfMeans> half_means_of(const Filter& filter);

// Where the samples lie, by the halves of a pixel: on the sides that rows cross, on those that
// columns cross, at corners.
enum class Half : std::uint8_t { beside, below, corner };

// The samples of a tile's pixels on these, each once; those of neighbouring pixels are next to each
// other, and those of a pixel that is not wanted may be among them where that makes longer runs.
// Memory, used again.
class HalfGrid {
 public:
  static constexpr std::size_t kinds = 3;

  // Makes room for the rect and finds what the pixels want, which are in row-major order.
  void begin(const Rect& rect, std::span<const Pixel> pixels, std::size_t outputs);

  // A run of samples to the right of the first, a pixel apart.
  struct Run {
    Half kind;
    std::int32_t x, y, count;  // in pixels of the rect
  };
  std::span<const Run> runs() const { return runs_; }

  // The middles of a run's samples, in pixels of the whole picture.
  void places(const Run& run, double* x, double* y) const;

  // Where a sample's value of an output is; those to its right follow. Sample (x, y) lies to the
  // left of, below, or left below the pixel (x, y) of the rect. `beyond` more may be read.
  static constexpr std::size_t beyond = 16;
  float* at(Half kind, std::size_t output, int x, int y) {
    return values_.data() + (output * kinds + static_cast<std::size_t>(kind)) * plane_ +
           static_cast<std::size_t>(y) * row_ + static_cast<std::size_t>(x);
  }
  std::size_t row() const { return row_; }

 private:
  Rect rect_;
  std::size_t row_ = 0, plane_ = 0;
  std::vector<std::uint8_t> wanted_;
  std::vector<float> values_;
  std::vector<Run> runs_;
};

}  // namespace pse::antialias
