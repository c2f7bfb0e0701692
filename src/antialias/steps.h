// What is done for many pixels at once: the same results, for different instructions. The bodies
// are in neighbours.h, fine_steps.h, half_steps.h, smooth_steps.h, crossing_steps.h and
// sample_steps.h, and steps_any.cpp and its like compile them.
#pragma once

#include "antialias/crossings.h"
#include "antialias/half_grid.h"
#include "antialias/smooth.h"
#include "antialias/tile.h"

namespace pse::antialias {

// Room for the search: `changes` for the samples of the area, `found` for the pixels of the tile
// and `beyond` more.
struct SearchRoom {
  static constexpr std::size_t beyond = 16;
  std::uint16_t* changes;
  Pixel* found;
};

// Where the first pixel of a row and its samples are.
struct HalfRow {
  const float *path, *middles;           // of the tile
  const float *beside, *below, *corner;  // of the half grid
  std::ptrdiff_t row, half_row;          // from a row to the next
};

// What the program of edges said at the crossings' pixels becomes of them; see refine.cpp.
enum class Nearness : std::int32_t { out_of_reach, one_edge, unclear };
// Then, as bits of which one is set at most: it has one edge to follow, it is unclear, its edge may
// be a circle's, it lies between the bends of a ramp.
inline constexpr std::int32_t to_follow = 1, to_sample = 2, to_fit = 4, to_smooth = 8;
// Of the kernel, of a second edge that matters, and of an edge that bends, from inside; 0: none
// does.
struct Reaches {
  float kernel, second, bent;
};

// Sum, least and largest of numbers.
struct Summary {
  float *sums, *lows, *highs;
};

// From and to, of pixel after pixel.
struct Ranges {
  const float *lows, *highs;
};
// What becomes of pixels by some samples of theirs: 0 is no.
struct Verdict {
  std::int32_t *more, *uneven;
};

// Lists may be read and written up to CrossingLists::beyond behind their ends.
struct Steps {
  // Writes the pixels that find_edge_pixels() wants and gives their number; for a reach of 1 and 2.
  using Search = std::size_t (*)(const Tile& tile, const SearchRoom& room);
  std::array<Search, 2> search;
  // Likewise the pixels that find_fine_pixels() wants; tile.fine is not null.
  std::size_t (*find_fine)(const Tile& tile, Pixel* found);
  // Smooths some of the tile's planes, and moves their rows together as if the area were the rect.
  void (*smooth)(const Tile& tile, const Smoothing& by, std::span<float* const> planes);

  // The means of pixels in a row from samples half a pixel apart; they may be written up to 16
  // behind their end.
  void (*mean_of_halves)(const HalfRow& at, const HalfMeans& by, std::size_t count, float* means);

  // Of the crossings' pixels, where the edges are `lines` (edge_outputs lists, derive.h): is an
  // edge within `farthest`, are two within `reach` of the kernel, do they explain every jump?
  void (*see_nearness)(const CrossingLists& crossings, const float* const* lines, float reach,
                       float farthest, Nearness* nearness);
  // The fates of the same pixels.
  void (*find_fates)(const CrossingLists& crossings, const float* const* lines,
                     const Nearness* nearness, const Reaches& reaches, std::int32_t* fates);
  // From where the crossings' edges are looked at again: a little along them, on their far sides.
  void (*find_second_looks)(const CrossingLists& crossings, float reach, double* x, double* y);
  // Distances, bends, others and is_one from the edges that were seen there.
  void (*look_again)(const CrossingLists& crossings, const float* const* lines, float reach);
  // Shares and middles of the sides from those of a straight edge: `share`, and its moment in
  // `towards`.
  void (*bend_shares)(const CrossingLists& crossings);
  // The middles of the sides that the normals point to, then those of the others.
  void (*find_sides)(const CrossingLists& crossings, double* x, double* y);

  // Of an output: whether some of what its samples are, `seen`, can be told from all that is
  // `known` (asked where `asks` is -1), and whether a part of what it spreads over can be seen.
  // Adds to the verdict.
  void (*judge)(Ranges seen, Ranges known, const std::int32_t* asks, Ranges spread, float parts,
                std::size_t count, Verdict verdict);
  // `each` places at these offsets from one.
  void (*place)(double x, double y, const float* offset_x, const float* offset_y, std::size_t each,
                double* to_x, double* to_y);
  // values[k * each + i], i < each: those of number k.
  void (*summarise)(const float* values, std::size_t count, std::size_t each,
                    const Summary& summary);
};
const Steps& steps_for_any();
const Steps& steps_for_avx2();
const Steps& steps_for_avx512();
// Those of this processor.
const Steps& steps();

}  // namespace pse::antialias
