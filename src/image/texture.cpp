// Lookup of stored textures; see texture.h.
#include "image/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pse::image {
namespace {

// The index of a texel, wrapped; -1 where there is none.
int wrapped(int i, int n, Wrap wrap) {
  if (i >= 0 && i < n) return i;
  switch (wrap) {
    case Wrap::repeat: {
      const int rest = i % n;
      return rest < 0 ? rest + n : rest;
    }
    case Wrap::clamp:
      return i < 0 ? 0 : n - 1;
    case Wrap::mirror: {
      int rest = i % (2 * n);
      if (rest < 0) rest += 2 * n;
      return rest < n ? rest : 2 * n - 1 - rest;
    }
    case Wrap::black:
      return -1;
  }
  return -1;
}

// A coordinate brought near the image, so that texel numbers stay small whatever it was.
float brought_near(float u, Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat:
      return u - std::floor(u);
    case Wrap::mirror: {
      const float t = u - 2.0f * std::floor(u * 0.5f);
      return t > 1.0f ? 2.0f - t : t;
    }
    case Wrap::clamp:
    case Wrap::black:
      return std::clamp(u, -4.0f, 5.0f);
  }
  return 0;
}

// Where a point lies among the texel centres of a row: the centre before it and how far beyond.
struct Between {
  int first = 0;
  float t = 0;
};

Between between(float x) {
  const float low = std::floor(x - 0.5f);
  return {static_cast<int>(low), (x - 0.5f) - low};
}

// The four weights of a Catmull-Rom segment, tension 1/2, at t in [0, 1].
std::array<float, 4> catmull_rom(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5f * (-t3 + 2.0f * t2 - t), 0.5f * (3.0f * t3 - 5.0f * t2 + 2.0f),
          0.5f * (-3.0f * t3 + 4.0f * t2 + t), 0.5f * (t3 - t2)};
}

// Which texels of a row a texel of a shorter row covers, and how much of each.
struct Cover {
  int first = 0;
  std::vector<double> weights;
};

std::vector<Cover> covers(int from, int to) {
  std::vector<Cover> list(static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    // The interval [i, i + 1) * from / to, in parts of 1 / to.
    const std::int64_t begin = std::int64_t{i} * from, end = begin + from;
    Cover& cover = list[static_cast<std::size_t>(i)];
    cover.first = static_cast<int>(begin / to);
    for (std::int64_t texel = cover.first; texel * to < end; ++texel) {
      const std::int64_t overlap = std::min(end, (texel + 1) * to) - std::max(begin, texel * to);
      cover.weights.push_back(double(overlap) / double(from));
    }
  }
  return list;
}

}  // namespace

std::optional<Wrap> wrap_from_name(std::string_view name) {
  if (name == "repeat") return Wrap::repeat;
  if (name == "clamp") return Wrap::clamp;
  if (name == "mirror") return Wrap::mirror;
  if (name == "black") return Wrap::black;
  return std::nullopt;
}

std::optional<Filter> filter_from_name(std::string_view name) {
  if (name == "nearest") return Filter::nearest;
  if (name == "linear") return Filter::linear;
  if (name == "cubic") return Filter::cubic;
  if (name == "mipmap") return Filter::mipmap;
  return std::nullopt;
}

namespace {

// Texels by column, row and component; where they are kept is settled before the loops.
struct InMemory {
  const float* values;
  std::size_t width, components;

  float operator()(int x, int y, std::size_t c) const {
    return values[(static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * components +
                  c];
  }
};
struct OnDisk {
  const Texels& texels;
  HeldTiles& held;

  float operator()(int x, int y, std::size_t c) const {
    return texels.value(x, y, static_cast<int>(c), held);
  }
};
template <class Work>
void with_texels(const Texels& texels, HeldTiles& held, Work work) {
  if (texels.in_memory())
    work(InMemory{texels.values(), static_cast<std::size_t>(texels.width()),
                  static_cast<std::size_t>(texels.components())});
  else
    work(OnDisk{texels, held});
}

// In these u and v are brought near, and v points down.

void look_up_nearest(const Texels& level, float u, float v, Wrap wrap, float* result,
                     HeldTiles& held) {
  const int x = wrapped(static_cast<int>(std::floor(u * static_cast<float>(level.width()))),
                        level.width(), wrap);
  const int y = wrapped(static_cast<int>(std::floor(v * static_cast<float>(level.height()))),
                        level.height(), wrap);
  if (x < 0 || y < 0) return;
  with_texels(level, held, [&](const auto& texel) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(level.components()); ++c)
      result[c] = texel(x, y, c);
  });
}

void look_up_linear(const Texels& level, float u, float v, Wrap wrap, float* result,
                    HeldTiles& held) {
  const Between bx = between(u * static_cast<float>(level.width()));
  const Between by = between(v * static_cast<float>(level.height()));
  const std::array<int, 2> xs = {wrapped(bx.first, level.width(), wrap),
                                 wrapped(bx.first + 1, level.width(), wrap)};
  const std::array<int, 2> ys = {wrapped(by.first, level.height(), wrap),
                                 wrapped(by.first + 1, level.height(), wrap)};
  with_texels(level, held, [&](const auto& texel) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(level.components()); ++c) {
      std::array<float, 4> corner{};
      for (std::size_t i = 0; i < 4; ++i) {
        const int x = xs[i & 1], y = ys[i >> 1];
        if (x >= 0 && y >= 0) corner[i] = texel(x, y, c);
      }
      // Where the weight is 0 the texel must not count, even if it is infinite.
      const auto mix = [](float a, float b, float t) { return t == 0 ? a : a + t * (b - a); };
      result[c] = mix(mix(corner[0], corner[1], bx.t), mix(corner[2], corner[3], bx.t), by.t);
    }
  });
}

void look_up_cubic(const Texels& level, float u, float v, Wrap wrap, float* result,
                   HeldTiles& held) {
  const Between bx = between(u * static_cast<float>(level.width()));
  const Between by = between(v * static_cast<float>(level.height()));
  const auto wx = catmull_rom(bx.t), wy = catmull_rom(by.t);
  with_texels(level, held, [&](const auto& texel) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(level.components()); ++c) {
      float sum = 0;
      for (int j = 0; j < 4; ++j) {
        const int y = wrapped(by.first - 1 + j, level.height(), wrap);
        if (y < 0 || wy[static_cast<std::size_t>(j)] == 0) continue;
        float row = 0;
        for (int i = 0; i < 4; ++i) {
          const int x = wrapped(bx.first - 1 + i, level.width(), wrap);
          if (x < 0 || wx[static_cast<std::size_t>(i)] == 0) continue;
          row += wx[static_cast<std::size_t>(i)] * texel(x, y, c);
        }
        sum += wy[static_cast<std::size_t>(j)] * row;
      }
      result[c] = sum;
    }
  });
}

// The part of the data window that lies in the frame.
Window inside(const Window& frame, const Window& data) {
  return {std::max(frame.x0, data.x0), std::max(frame.y0, data.y0), std::min(frame.x1, data.x1),
          std::min(frame.y1, data.y1)};
}

// Fills texels of the frame's size with rows of the data window: plane(c, y) is component c of row
// y, from data.x0 on.
template <class Plane>
Result<void> fill_rows(Texels& texels, const Window& frame, const Window& data, int y0, int y1,
                       const Plane& plane) {
  const Window part = inside(frame, data);
  const auto n = static_cast<std::size_t>(texels.components());
  std::vector<float> row(static_cast<std::size_t>(frame.width()) * n);
  for (int y = y0; y < y1; ++y) {
    std::ranges::fill(row, 0.0f);
    if (y >= part.y0 && y < part.y1)
      for (std::size_t c = 0; c < n; ++c) {
        const float* from = plane(c, y);
        for (int x = part.x0; x < part.x1; ++x)
          row[static_cast<std::size_t>(x - frame.x0) * n + c] = from[x - data.x0];
      }
    if (auto added = texels.add_row(row); !added) return added;
  }
  return {};
}

// An image's texels in memory.
Texels texels_of(const Image& image, std::span<const int> channels) {
  const Window &frame = image.spec.display, &data = image.spec.data;
  Texels texels(frame.width(), frame.height(), static_cast<int>(channels.size()));
  const auto filled = fill_rows(texels, frame, data, frame.y0, frame.y1, [&](std::size_t c, int y) {
    return image.planes[static_cast<std::size_t>(channels[c])].data() +
           std::int64_t{y - data.y0} * data.width();
  });
  static_cast<void>(filled);  // memory takes all
  return texels;
}

}  // namespace

Texture::Texture(const Image& image, std::span<const int> channels)
    : full_(texels_of(image, channels)) {}

void Texture::look_up(float u, float v, float size, Filter filter, Wrap wrap, float* result,
                      HeldTiles& held) const {
  std::fill_n(result, components(), 0.0f);
  if (!std::isfinite(u) || !std::isfinite(v)) return;
  u = brought_near(u, wrap);
  v = 1.0f - brought_near(v, wrap);
  switch (filter) {
    case Filter::nearest:
      return look_up_nearest(full_, u, v, wrap, result, held);
    case Filter::linear:
      return look_up_linear(full_, u, v, wrap, result, held);
    case Filter::cubic:
      return look_up_cubic(full_, u, v, wrap, result, held);
    case Filter::mipmap:
      return look_up_mipmap(u, v, size, wrap, result, held);
  }
}

void Texture::look_up_mipmap(float u, float v, float size, Wrap wrap, float* result,
                             HeldTiles& held) const {
  // How many texels of the full size the value shall cover, and which level has texels of that
  // size.
  const float texels = size * static_cast<float>(std::max(width(), height()));
  if (!(texels > 1.0f)) return look_up_linear(full_, u, v, wrap, result, held);
  const auto& smaller = pyramid();
  int power = 0;
  const float rest = 2.0f * std::frexp(std::min(texels, 1e30f), &power) - 1.0f;
  const std::size_t low = static_cast<std::size_t>(power - 1);
  if (low >= smaller.size())
    return look_up_linear(smaller.empty() ? full_ : smaller.back(), u, v, wrap, result, held);
  look_up_linear(low == 0 ? full_ : smaller[low - 1], u, v, wrap, result, held);
  if (rest == 0) return;
  std::array<float, 16> coarse{};
  std::vector<float> many(components() > 16 ? static_cast<std::size_t>(components()) : 0);
  float* second = many.empty() ? coarse.data() : many.data();
  look_up_linear(smaller[low], u, v, wrap, second, held);
  for (int c = 0; c < components(); ++c) result[c] = result[c] + rest * (second[c] - result[c]);
}

// The next smaller image: each texel is the mean of what it covers, also where sizes are odd.
Result<Texels> Texture::halved(const Texels& from) const {
  const int width = std::max(1, from.width() / 2), height = std::max(1, from.height() / 2);
  const bool large =
      !full_.in_memory() && cache_ && Texels::bytes(width, height, components()) > small_;
  auto to = large ? Texels::on_disk(width, height, components(), cache_)
                  : Result<Texels>(Texels(width, height, components()));
  if (!to) return to;
  const auto n = static_cast<std::size_t>(components());
  const auto columns = covers(from.width(), width), rows = covers(from.height(), height);
  Texels::Rows source(from);
  std::vector<float> made(static_cast<std::size_t>(width) * n);
  std::vector<const float*> covered;
  for (const Cover& row : rows) {
    covered.clear();
    for (int j = 0; j < static_cast<int>(row.weights.size()); ++j)
      covered.push_back(source.row(row.first + j));
    std::size_t out = 0;
    for (const Cover& column : columns)
      for (std::size_t c = 0; c < n; ++c) {
        double sum = 0;
        for (std::size_t j = 0; j < row.weights.size(); ++j)
          for (std::size_t i = 0; i < column.weights.size(); ++i) {
            const std::size_t at = (static_cast<std::size_t>(column.first) + i) * n + c;
            sum += row.weights[j] * column.weights[i] * double{covered[j][at]};
          }
        made[out++] = static_cast<float>(sum);
      }
    if (auto added = to->add_row(made); !added) return std::unexpected(added.error());
  }
  return to;
}

const std::vector<Texels>& Texture::pyramid() const {
  std::call_once(built_, [this] {
    const Texels* last = &full_;
    std::vector<Texels> made;
    made.reserve(32);
    while (last->width() > 1 || last->height() > 1) {
      auto next = halved(*last);
      if (!next) {
        made_ = std::unexpected(next.error());
        return;
      }
      made.push_back(std::move(*next));
      last = &made.back();
    }
    smaller_ = std::move(made);
  });
  return smaller_;
}

Result<void> Texture::prepare(Filter filter) const {
  if (filter == Filter::mipmap) pyramid();
  return made_;
}

TextureCache::TextureCache(ReadOptions options,
                           std::function<std::string(const std::string&)> resolve,
                           const TextureMemory& memory)
    : options_(std::move(options)),
      resolve_(std::move(resolve)),
      memory_(memory),
      tiles_(std::make_shared<TileCache>(memory.tiles)),
      whole_left_(memory.whole) {}

Result<TextureCache::Opened> TextureCache::open(const std::string& file,
                                                const std::string& layer) const {
  ReadOptions options = options_;
  if (layer == "data") options.working.reset();
  auto reader = open_reader(resolve_ ? resolve_(file) : file, options);
  if (!reader) return std::unexpected(reader.error());
  const ImageSpec& spec = (*reader)->spec();

  if (layer == "data") {
    Layer all{"data", {}, false};
    for (const char* name : {"R", "G", "B", "A"})
      if (const int c = spec.find(name); spec.find("R") >= 0 && c >= 0) all.channels.push_back(c);
    for (std::size_t c = 0; spec.find("R") < 0 && c < spec.channels.size() && c < 4; ++c)
      all.channels.push_back(static_cast<int>(c));
    return Opened{std::move(*reader), all};
  }
  const auto layers = layers_of(spec);
  if (const Layer* found = find_layer(layers, layer)) return Opened{std::move(*reader), *found};
  std::string names;
  for (const auto& there : layers) names += (names.empty() ? "" : ", ") + there.name;
  return fail(ErrorKind::bad_request, file + " has no layer " + layer + "; it has " + names);
}

Result<int> TextureCache::components(const std::string& file, const std::string& layer) {
  auto opened = open(file, layer);
  if (!opened) return std::unexpected(opened.error());
  return opened->layer.components();
}

Result<std::pair<int, int>> TextureCache::size(const std::string& file) const {
  const auto reader = open_reader(resolve_ ? resolve_(file) : file, options_);
  if (!reader) return std::unexpected(reader.error());
  const Window& display = (*reader)->spec().display;
  return std::pair(display.width(), display.height());
}

Result<std::shared_ptr<const Texture>> TextureCache::read(const std::string& file,
                                                          const std::string& layer) {
  auto opened = open(file, layer);
  if (!opened) return std::unexpected(opened.error());
  // The frame is kept whole, even where only a part of it has data.
  const ImageSpec& spec = opened->reader->spec();
  const Window &frame = spec.display, &data = spec.data;
  const int components = opened->layer.components();
  if (double(frame.pixels()) * components * sizeof(float) > double(options_.limits.max_bytes) ||
      frame.width() < 1 || frame.height() < 1)
    return fail(ErrorKind::too_large, file + " is too large for a texture");
  std::vector<int> channels, plane_of;
  for (const int channel : opened->layer.channels) {
    const auto at = std::ranges::find(channels, channel);
    plane_of.push_back(static_cast<int>(at - channels.begin()));
    if (at == channels.end()) channels.push_back(channel);
  }

  // Smaller sizes take a third more.
  const std::int64_t bytes = Texels::bytes(frame.width(), frame.height(), components) / 3 * 4;
  bool whole = bytes <= memory_.small;
  if (const std::lock_guard lock(mutex_); !whole && bytes <= whole_left_)
    whole = true, whole_left_ -= bytes;

  // Rows come in bands of a row of tiles.
  try {
    auto texels = whole ? Result<Texels>(Texels(frame.width(), frame.height(), components))
                        : Texels::on_disk(frame.width(), frame.height(), components, tiles_);
    if (!texels) return std::unexpected(texels.error());
    const Window part = inside(frame, data);
    const auto width = static_cast<std::size_t>(data.width());
    if (double(width) * tile_size * double(channels.size()) * sizeof(float) >
        double(options_.limits.max_band_bytes))
      return fail(ErrorKind::too_large, file + " is too large for a texture");
    std::vector<std::vector<float>> planes(channels.size(), std::vector<float>(width * tile_size));
    std::vector<float*> into;
    for (auto& plane : planes) into.push_back(plane.data());
    for (int y = frame.y0; y < frame.y1; y += tile_size) {
      const int end = std::min(y + tile_size, frame.y1);
      const int first = std::max(y, part.y0), last = std::min(end, part.y1);
      if (first < last)
        if (auto done = opened->reader->read_rows(first, last, channels, into); !done)
          return std::unexpected(done.error());
      const auto filled = fill_rows(*texels, frame, data, y, end, [&](std::size_t c, int row) {
        return into[static_cast<std::size_t>(plane_of[c])] +
               static_cast<std::size_t>(row - first) * width;
      });
      if (!filled) return std::unexpected(filled.error());
    }
    return std::make_shared<const Texture>(std::move(*texels), tiles_, memory_.small);
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory for the texture " + file);
  }
}

Result<std::shared_ptr<const Texture>> TextureCache::load(const std::string& file,
                                                          const std::string& layer) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& place = entries_[{file, layer}];
    if (!place) place = std::make_shared<Entry>();
    entry = place;
  }
  std::call_once(entry->once, [&] { entry->texture = read(file, layer); });
  return entry->texture;
}

void TextureCall::run(void* self, std::int64_t count, const float* const* arguments,
                      float* const* results) {
  const auto& call = *static_cast<const TextureCall*>(self);
  const auto n = static_cast<std::size_t>(call.texture->components());
  std::array<float, 16> few{};
  std::vector<float> many(n > few.size() ? n : 0);
  float* value = many.empty() ? few.data() : many.data();
  HeldTiles held;
  for (std::int64_t i = 0; i < count; ++i) {
    call.texture->look_up(arguments[0][i], arguments[1][i], call.has_width ? arguments[2][i] : 0.0f,
                          call.filter, call.wrap, value, held);
    for (std::size_t c = 0; c < n; ++c) results[c][i] = value[c];
  }
}

}  // namespace pse::image
