// An image looked up at any coordinates: `texture("wood.exr", u, v)` of the language. (0, 0) is the
// lower left corner of the frame, (1, 1) the upper right one; pixels of the frame without data are
// 0. The result of a lookup depends on nothing but its arguments, so it has the same bits in
// batches of any size.
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
  // Of the channels of a layer; the same channel may come twice.
  Texture(const Image& image, std::span<const int> channels);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  int components() const { return components_; }

  // `size` is the width that the value shall cover, in units of u and v; only Filter::mipmap looks
  // at it. Between powers of two the level is chosen linearly in `size`. Where u or v is NaN or
  // infinite the result is 0.
  void look_up(float u, float v, float size, Filter filter, Wrap wrap, float* result) const;
  // Makes now what the filter would make at its first lookup: of a large image that takes a second.
  void prepare(Filter filter) const {
    if (filter == Filter::mipmap) pyramid();
  }

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<float> texels;  // components interleaved
  };
  void look_up_linear(const Level& level, float u, float v, Wrap wrap, float* result) const;
  void look_up_cubic(float u, float v, Wrap wrap, float* result) const;
  void look_up_mipmap(float u, float v, float size, Wrap wrap, float* result) const;
  Level halved(const Level& from) const;
  const std::vector<Level>& pyramid() const;

  int components_ = 0;
  std::vector<Level> levels_;  // the full size
  mutable std::once_flag built_;
  mutable std::vector<Level> smaller_;  // made when first needed
};

// Textures by file and layer, each loaded once. Safe to use from several threads.
class TextureCache {
 public:
  // `resolve` turns a program's file name into a path (the asset folders of PSE_PATH); empty: as it
  // is.
  explicit TextureCache(ReadOptions options = {},
                        std::function<std::string(const std::string&)> resolve = {});

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
  Result<std::shared_ptr<const Texture>> read(const std::string& file,
                                              const std::string& layer) const;

  ReadOptions options_;
  std::function<std::string(const std::string&)> resolve_;
  std::mutex mutex_;
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
