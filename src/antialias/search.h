// The searches for edge pixels that tile.cpp chooses from: the same, for different instructions.
#pragma once

#include "antialias/tile.h"

namespace pse::antialias {

// Room for the search: `changes` for the samples of the area and of one row more, `found` for the
// pixels of the tile; each with `beyond` more.
struct SearchRoom {
  static constexpr std::size_t beyond = 16;
  std::int32_t* changes;
  Pixel* found;
};
// Writes the pixels that find_edge_pixels() wants and gives their number.
using SearchFunction = std::size_t (*)(const Tile& tile, const SearchRoom& room);
// reach: 1 or 2.
SearchFunction search_for_any(int reach);
SearchFunction search_for_avx2(int reach);
SearchFunction search_for_avx512(int reach);

}  // namespace pse::antialias
