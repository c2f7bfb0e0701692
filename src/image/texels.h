// The pixels of a texture at one size, components interleaved: in memory, or where that is too much
// in a file without a name in $TMPDIR, cut into tiles that are read back when somebody looks at
// them. Between reader.h, whose rows fill it, and texture.h, which looks single texels up. What a
// texel is does not depend on where it is kept.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "image/error.h"

namespace pse::image {

inline constexpr int tile_size = 64;  // texels on each side

// tile_size x tile_size texels, row by row; those outside the picture are 0.
using Tile = std::shared_ptr<const std::vector<float>>;

// The tiles in memory of all textures that share it; those used last stay. Safe to use from several
// threads.
class TileCache {
 public:
  // Keeps about so many bytes, and in each of its parts one tile at least.
  explicit TileCache(std::int64_t bytes) : bytes_per_part_(bytes / parts) {}

  Tile find(std::uint64_t key);
  void keep(std::uint64_t key, const Tile& tile);
  // A number for the texels of one size, which makes the upper half of their tiles' keys.
  std::uint32_t new_owner();

 private:
  static constexpr std::size_t parts = 16;  // each under its own lock
  struct Part {
    std::mutex mutex;
    std::list<std::pair<std::uint64_t, Tile>> used;  // the last used first
    std::unordered_map<std::uint64_t, decltype(used)::iterator> by_key;
    std::int64_t bytes = 0;
  };
  Part& part(std::uint64_t key) { return parts_[key % parts]; }

  std::int64_t bytes_per_part_;
  std::array<Part, parts> parts_;
  std::mutex owner_mutex_;
  std::uint32_t owners_ = 0;
};

// The tiles that one thread looked at last, so that looking at the same ones again asks nobody.
class HeldTiles {
 public:
  struct Slot {
    std::uint64_t key = ~std::uint64_t{0};
    Tile tile;
  };
  // Neighbouring tiles, and those of the next smaller size, have different slots.
  Slot& slot(std::uint64_t key, int across, int down) {
    return slots_[(key >> 32 & 1) * 4 + static_cast<std::size_t>((down & 1) * 2 + (across & 1))];
  }

 private:
  std::array<Slot, 8> slots_;
};

class Texels {
 public:
  // In memory.
  Texels(int width, int height, int components);
  // In a file; the error says that there is no room.
  static Result<Texels> on_disk(int width, int height, int components,
                                std::shared_ptr<TileCache> cache);
  Texels(Texels&& from) noexcept;
  Texels& operator=(Texels&&) = delete;
  ~Texels();

  int width() const { return width_; }
  int height() const { return height_; }
  int components() const { return components_; }
  bool in_memory() const { return file_ < 0; }
  static std::int64_t bytes(int width, int height, int components) {
    return std::int64_t{width} * height * components * std::int64_t{sizeof(float)};
  }

  // The next row, of width * components floats. After `height` of them the texels are whole; only
  // then may they be looked at.
  Result<void> add_row(std::span<const float> row);

  // Texels in memory: where they begin.
  const float* values() const { return values_.data(); }
  // Texels on disk: the value of a component. What the disk does not give back is NaN.
  float value(int x, int y, int component, HeldTiles& held) const;

  // Rows from top to bottom, of which one may go back by tile_size.
  class Rows {
   public:
    explicit Rows(const Texels& texels) : texels_(texels) {}
    const float* row(int y);

   private:
    const Texels& texels_;
    std::array<std::vector<float>, 2> bands_;  // rows of tiles, put together again
    std::array<int, 2> numbers_{-1, -1};
  };

 private:
  std::size_t tile_values() const {
    return std::size_t{tile_size} * tile_size * static_cast<std::size_t>(components_);
  }
  int tiles_across() const { return (width_ + tile_size - 1) / tile_size; }
  Tile read_tile(int across, int down) const;
  Result<void> write_band();

  int width_, height_, components_;
  int rows_ = 0;               // added so far
  std::vector<float> values_;  // all, or of texels on disk the row of tiles in the making
  int file_ = -1;
  std::shared_ptr<TileCache> cache_;
  std::uint64_t owner_ = 0;  // in the upper half
};

}  // namespace pse::image
