// Texels in memory and in tiles of a file; see texels.h.
#include "image/texels.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string>

#include "image/plain_file.h"

namespace pse::image {

// ---- Tiles in memory ----

Tile TileCache::find(std::uint64_t key) {
  Part& part = this->part(key);
  const std::lock_guard lock(part.mutex);
  const auto found = part.by_key.find(key);
  if (found == part.by_key.end()) return nullptr;
  part.used.splice(part.used.begin(), part.used, found->second);
  return found->second->second;
}

void TileCache::keep(std::uint64_t key, const Tile& tile) {
  const auto size = [](const Tile& one) {
    return static_cast<std::int64_t>(one->size() * sizeof(float));
  };
  Part& part = this->part(key);
  const std::lock_guard lock(part.mutex);
  if (part.by_key.contains(key)) return;  // another thread was quicker
  part.used.emplace_front(key, tile);
  part.by_key[key] = part.used.begin();
  part.bytes += size(tile);
  while (part.bytes > bytes_per_part_ && part.used.size() > 1) {
    part.bytes -= size(part.used.back().second);
    part.by_key.erase(part.used.back().first);
    part.used.pop_back();
  }
}

std::uint32_t TileCache::new_owner() {
  const std::lock_guard lock(owner_mutex_);
  return owners_++;
}

// ---- Texels ----

Texels::Texels(int width, int height, int components)
    : width_(width), height_(height), components_(components) {
  values_.reserve(static_cast<std::size_t>(bytes(width, height, components)) / sizeof(float));
}

Result<Texels> Texels::on_disk(int width, int height, int components,
                               std::shared_ptr<TileCache> cache) {
  Texels texels(0, 0, components);
  texels.width_ = width, texels.height_ = height;
  texels.file_ = nameless_file();
  if (texels.file_ < 0)
    return fail(ErrorKind::cannot_read, std::string("no room to keep a large texture (") +
                                            std::strerror(errno) + "); TMPDIR names the folder");
  texels.owner_ = std::uint64_t{cache->new_owner()} << 32;
  texels.cache_ = std::move(cache);
  return texels;
}

Texels::Texels(Texels&& from) noexcept
    : width_(from.width_),
      height_(from.height_),
      components_(from.components_),
      rows_(from.rows_),
      values_(std::move(from.values_)),
      file_(std::exchange(from.file_, -1)),
      cache_(std::move(from.cache_)),
      owner_(from.owner_) {}

Texels::~Texels() {
  if (file_ >= 0) ::close(file_);
}

Result<void> Texels::add_row(std::span<const float> row) {
  values_.insert(values_.end(), row.begin(), row.end());
  ++rows_;
  if (in_memory() || (rows_ % tile_size != 0 && rows_ != height_)) return {};
  return write_band();
}

// Cuts the rows since the last row of tiles into tiles, one behind the other.
Result<void> Texels::write_band() {
  const auto n = static_cast<std::size_t>(components_), width = static_cast<std::size_t>(width_);
  const std::size_t rows = values_.size() / (width * n);
  std::vector<float> tile;
  for (std::size_t x = 0; x < width; x += tile_size) {
    tile.assign(tile_values(), 0.0f);
    const std::size_t count = std::min<std::size_t>(tile_size, width - x) * n;
    for (std::size_t y = 0; y < rows; ++y)
      std::copy_n(values_.data() + (y * width + x) * n, count, tile.data() + y * tile_size * n);
    if (!write_all(file_, tile.data(), tile.size() * sizeof(float)))
      return fail(ErrorKind::cannot_read, std::string("no room to keep a large texture (") +
                                              std::strerror(errno) + "); TMPDIR names the folder");
  }
  values_.clear();
  if (rows_ == height_) values_.shrink_to_fit();
  return {};
}

Tile Texels::read_tile(int across, int down) const {
  auto values = std::make_shared<std::vector<float>>(tile_values());
  const std::size_t size = values->size() * sizeof(float);
  const auto number = std::uint64_t(down) * std::uint64_t(tiles_across()) + std::uint64_t(across);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(file_, reinterpret_cast<char*>(values->data()) + done, size - done,
                                static_cast<off_t>(number * size + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      std::ranges::fill(*values, std::numeric_limits<float>::quiet_NaN());
      break;
    }
    done += static_cast<std::size_t>(got);
  }
  return values;
}

float Texels::value(int x, int y, int component, HeldTiles& held) const {
  const int across = x / tile_size, down = y / tile_size;
  const auto number = static_cast<std::uint32_t>(down * tiles_across() + across);
  const std::uint64_t key = owner_ | number;
  HeldTiles::Slot& slot = held.slot(key, across, down);
  if (slot.key != key) {
    slot.tile = cache_->find(key);
    if (!slot.tile) {
      slot.tile = read_tile(across, down);
      cache_->keep(key, slot.tile);
    }
    slot.key = key;
  }
  const int place = (y % tile_size) * tile_size + x % tile_size;
  return (*slot.tile)[static_cast<std::size_t>(place) * static_cast<std::size_t>(components_) +
                      static_cast<std::size_t>(component)];
}

const float* Texels::Rows::row(int y) {
  const auto n = static_cast<std::size_t>(texels_.components_),
             row_values = static_cast<std::size_t>(texels_.width_) * n;
  if (texels_.in_memory()) return texels_.values() + static_cast<std::size_t>(y) * row_values;
  const int number = y / tile_size;
  const auto slot = static_cast<std::size_t>(number & 1);
  std::vector<float>& band = bands_[slot];
  if (numbers_[slot] != number) {
    numbers_[slot] = number;
    band.resize(row_values * tile_size);
    for (int across = 0; across < texels_.tiles_across(); ++across) {
      const Tile tile = texels_.read_tile(across, number);
      const int x = across * tile_size;
      const auto count = static_cast<std::size_t>(std::min(tile_size, texels_.width_ - x)) * n;
      for (std::size_t row = 0; row < tile_size; ++row)
        std::copy_n(tile->data() + row * tile_size * n, count,
                    band.data() + row * row_values + static_cast<std::size_t>(x) * n);
    }
  }
  return band.data() + static_cast<std::size_t>(y % tile_size) * row_values;
}

}  // namespace pse::image
