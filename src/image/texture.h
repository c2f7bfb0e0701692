// An image looked up at any coordinates: `texture("wood.exr", u, v)` of the language. (0, 0) is the
// lower left corner of the frame, (1, 1) the upper right one; pixels of the frame without data are
// 0. The result of a lookup depends on nothing but its arguments, so it has the same bits in
// batches of any size. A large image is kept in tiles on the disk (texels.h) and looked up there
// with the same bits.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/layers.h"
#include "image/reader.h"
#include "image/texels.h"

namespace pse::image {

enum class Wrap {
  repeat,  // the image is a tile of an endless pattern
  clamp,   // outside, the nearest edge
  mirror,  // every other tile is turned round
  black    // outside, 0
};
enum class Filter {
  nearest,  // the pixel that the point lies in
  linear,   // between the four nearest centres
  cubic,    // Catmull-Rom through the sixteen nearest centres; may overshoot
  mipmap    // linear in halved images and between two of them, so that one value covers `width`
};
std::optional<Wrap> wrap_from_name(std::string_view name);
std::optional<Filter> filter_from_name(std::string_view name);

class Texture {
 public:
  // Of the channels of a layer; the same channel may come twice. In memory.
  Texture(const Image& image, std::span<const int> channels);
  // Of texels that are whole. Smaller sizes of texels on disk go there too, read by way of `cache`,
  // as long as they take more than `small` bytes.
  explicit Texture(Texels texels, std::shared_ptr<TileCache> cache = {}, std::int64_t small = 0)
      : full_(std::move(texels)), cache_(std::move(cache)), small_(small) {}

  int width() const { return full_.width(); }
  int height() const { return full_.height(); }
  int components() const { return full_.components(); }
  bool in_memory() const { return full_.in_memory(); }

  // `size` is the width that the value shall cover, in units of u and v; only Filter::mipmap looks
  // at it. Between powers of two the level is chosen linearly in `size`. Where u or v is NaN or
  // infinite the result is 0. `held` belongs to one thread, and to this texture.
  void look_up(float u, float v, float size, Filter filter, Wrap wrap, float* result,
               HeldTiles& held) const;
  void look_up(float u, float v, float size, Filter filter, Wrap wrap, float* result) const {
    HeldTiles held;
    look_up(u, v, size, filter, wrap, result, held);
  }
  // Makes now what the filter would make at its first lookup: of a large image that takes a second.
  // Where that found no room the filter uses the full size only.
  Result<void> prepare(Filter filter) const;

 private:
  void look_up_mipmap(float u, float v, float size, Wrap wrap, float* result,
                      HeldTiles& held) const;
  Result<Texels> halved(const Texels& from) const;
  const std::vector<Texels>& pyramid() const;

  Texels full_;
  std::shared_ptr<TileCache> cache_;
  std::int64_t small_ = 0;
  mutable std::once_flag built_;
  mutable std::vector<Texels> smaller_;  // made when first needed
  mutable Result<void> made_;            // what became of them
};

// What the textures of one cache may take of the memory, in bytes: those that do not fit go to the
// disk.
struct TextureMemory {
  std::int64_t whole = std::int64_t{320} << 20;  // of textures in memory, smaller sizes included
  std::int64_t tiles = std::int64_t{96} << 20;   // of the others' tiles
  std::int64_t small = std::int64_t{4} << 20;    // a texture of less always stays in memory
};

// Textures by file and layer, each loaded once. Safe to use from several threads.
class TextureCache {
 public:
  // `resolve` turns a program's file name into a path (the asset folders of PSE_PATH); empty: as it
  // is.
  explicit TextureCache(ReadOptions options = {},
                        std::function<std::string(const std::string&)> resolve = {},
                        const TextureMemory& memory = {});

  // The layer `data` is the file's first channels, up to four, exactly as stored: for normal maps
  // kept in PNG.
  Result<std::shared_ptr<const Texture>> load(const std::string& file, const std::string& layer);
  // How many components that layer has; looks only at the header.
  Result<int> components(const std::string& file, const std::string& layer);
  // The frame's width and height; looks only at the header.
  Result<std::pair<int, int>> size(const std::string& file) const;

 private:
  struct Opened {
    std::unique_ptr<ImageReader> reader;
    Layer layer;
  };
  struct Entry {
    std::once_flag once;
    Result<std::shared_ptr<const Texture>> texture = std::shared_ptr<const Texture>();
  };
  Result<Opened> open(const std::string& file, const std::string& layer) const;
  Result<std::shared_ptr<const Texture>> read(const std::string& file, const std::string& layer);

  ReadOptions options_;
  std::function<std::string(const std::string&)> resolve_;
  TextureMemory memory_;
  std::shared_ptr<TileCache> tiles_;
  std::mutex mutex_;         // of what follows
  std::int64_t whole_left_;  // bytes for textures in memory
  std::map<std::pair<std::string, std::string>, std::shared_ptr<Entry>> entries_;
};

// One texture() of a program, as a function of the host for the kernel (codegen/kernel.h):
// arguments u, v and perhaps the width; results the components.
struct TextureCall {
  std::shared_ptr<const Texture> texture;
  Filter filter = Filter::linear;
  Wrap wrap = Wrap::repeat;
  bool has_width = false;

  static void run(void* self, std::int64_t count, const float* const* arguments,
                  float* const* results);
};

}  // namespace pse::image
