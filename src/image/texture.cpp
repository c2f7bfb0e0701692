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

Texture::Texture(const Image& image, std::span<const int> channels)
    : components_(static_cast<int>(channels.size())), levels_(1) {
  const Window &frame = image.spec.display, &data = image.spec.data;
  Level& full = levels_.front();
  full.width = frame.width();
  full.height = frame.height();
  const auto n = static_cast<std::size_t>(components_);
  full.texels.assign(n * static_cast<std::size_t>(frame.pixels()), 0.0f);
  const int x0 = std::max(frame.x0, data.x0), x1 = std::min(frame.x1, data.x1);
  const int y0 = std::max(frame.y0, data.y0), y1 = std::min(frame.y1, data.y1);
  for (std::size_t c = 0; c < n; ++c)
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const std::int64_t at = std::int64_t{y - frame.y0} * frame.width() + (x - frame.x0);
        full.texels[static_cast<std::size_t>(at) * n + c] = image.at(channels[c], x, y);
      }
}

void Texture::look_up(float u, float v, float size, Filter filter, Wrap wrap, float* result) const {
  std::fill_n(result, components_, 0.0f);
  if (!std::isfinite(u) || !std::isfinite(v)) return;
  u = brought_near(u, wrap);
  v = 1.0f - brought_near(v, wrap);
  const Level& full = levels_.front();
  switch (filter) {
    case Filter::nearest: {
      const int x = wrapped(static_cast<int>(std::floor(u * static_cast<float>(full.width))),
                            full.width, wrap);
      const int y = wrapped(static_cast<int>(std::floor(v * static_cast<float>(full.height))),
                            full.height, wrap);
      if (x < 0 || y < 0) return;
      const std::size_t at = static_cast<std::size_t>(std::int64_t{y} * full.width + x);
      std::copy_n(full.texels.data() + at * static_cast<std::size_t>(components_), components_,
                  result);
      return;
    }
    case Filter::linear:
      return look_up_linear(full, u, v, wrap, result);
    case Filter::cubic:
      return look_up_cubic(u, v, wrap, result);
    case Filter::mipmap:
      return look_up_mipmap(u, v, size, wrap, result);
  }
}

// u and v are brought near, and v points down.
void Texture::look_up_linear(const Level& level, float u, float v, Wrap wrap, float* result) const {
  const Between bx = between(u * static_cast<float>(level.width));
  const Between by = between(v * static_cast<float>(level.height));
  const std::array<int, 2> xs = {wrapped(bx.first, level.width, wrap),
                                 wrapped(bx.first + 1, level.width, wrap)};
  const std::array<int, 2> ys = {wrapped(by.first, level.height, wrap),
                                 wrapped(by.first + 1, level.height, wrap)};
  const auto n = static_cast<std::size_t>(components_);
  for (std::size_t c = 0; c < n; ++c) {
    std::array<float, 4> corner{};
    for (std::size_t i = 0; i < 4; ++i) {
      const int x = xs[i & 1], y = ys[i >> 1];
      if (x >= 0 && y >= 0)
        corner[i] =
            level.texels[static_cast<std::size_t>(std::int64_t{y} * level.width + x) * n + c];
    }
    // Where the weight is 0 the texel must not count, even if it is infinite.
    const auto mix = [](float a, float b, float t) { return t == 0 ? a : a + t * (b - a); };
    result[c] = mix(mix(corner[0], corner[1], bx.t), mix(corner[2], corner[3], bx.t), by.t);
  }
}

void Texture::look_up_cubic(float u, float v, Wrap wrap, float* result) const {
  const Level& level = levels_.front();
  const Between bx = between(u * static_cast<float>(level.width));
  const Between by = between(v * static_cast<float>(level.height));
  const auto wx = catmull_rom(bx.t), wy = catmull_rom(by.t);
  const auto n = static_cast<std::size_t>(components_);
  for (std::size_t c = 0; c < n; ++c) {
    float sum = 0;
    for (int j = 0; j < 4; ++j) {
      const int y = wrapped(by.first - 1 + j, level.height, wrap);
      if (y < 0 || wy[static_cast<std::size_t>(j)] == 0) continue;
      float row = 0;
      for (int i = 0; i < 4; ++i) {
        const int x = wrapped(bx.first - 1 + i, level.width, wrap);
        if (x < 0 || wx[static_cast<std::size_t>(i)] == 0) continue;
        const std::size_t at = static_cast<std::size_t>(std::int64_t{y} * level.width + x);
        row += wx[static_cast<std::size_t>(i)] * level.texels[at * n + c];
      }
      sum += wy[static_cast<std::size_t>(j)] * row;
    }
    result[c] = sum;
  }
}

void Texture::look_up_mipmap(float u, float v, float size, Wrap wrap, float* result) const {
  // How many texels of the full size the value shall cover, and which level has texels of that
  // size.
  const float texels = size * static_cast<float>(std::max(width(), height()));
  if (!(texels > 1.0f)) return look_up_linear(levels_.front(), u, v, wrap, result);
  const auto& smaller = pyramid();
  int power = 0;
  const float rest = 2.0f * std::frexp(std::min(texels, 1e30f), &power) - 1.0f;
  const std::size_t low = static_cast<std::size_t>(power - 1);
  if (low >= smaller.size())
    return look_up_linear(smaller.empty() ? levels_.front() : smaller.back(), u, v, wrap, result);
  look_up_linear(low == 0 ? levels_.front() : smaller[low - 1], u, v, wrap, result);
  if (rest == 0) return;
  std::array<float, 16> coarse{};
  std::vector<float> many(components_ > 16 ? static_cast<std::size_t>(components_) : 0);
  float* second = many.empty() ? coarse.data() : many.data();
  look_up_linear(smaller[low], u, v, wrap, second);
  for (int c = 0; c < components_; ++c) result[c] = result[c] + rest * (second[c] - result[c]);
}

// The next smaller image: each texel is the mean of what it covers, also where sizes are odd.
Texture::Level Texture::halved(const Level& from) const {
  Level to;
  to.width = std::max(1, from.width / 2);
  to.height = std::max(1, from.height / 2);
  const auto n = static_cast<std::size_t>(components_);
  to.texels.resize(n * static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height));
  const auto columns = covers(from.width, to.width), rows = covers(from.height, to.height);
  std::size_t out = 0;
  for (const Cover& row : rows)
    for (const Cover& column : columns)
      for (std::size_t c = 0; c < n; ++c) {
        double sum = 0;
        for (std::size_t j = 0; j < row.weights.size(); ++j)
          for (std::size_t i = 0; i < column.weights.size(); ++i) {
            const std::size_t at =
                (static_cast<std::size_t>(row.first) + j) * static_cast<std::size_t>(from.width) +
                static_cast<std::size_t>(column.first) + i;
            sum += row.weights[j] * column.weights[i] * double{from.texels[at * n + c]};
          }
        to.texels[out++] = static_cast<float>(sum);
      }
  return to;
}

const std::vector<Texture::Level>& Texture::pyramid() const {
  std::call_once(built_, [this] {
    const Level* last = &levels_.front();
    std::vector<Level> made;
    made.reserve(32);
    while (last->width > 1 || last->height > 1) {
      made.push_back(halved(*last));
      last = &made.back();
    }
    smaller_ = std::move(made);
  });
  return smaller_;
}

TextureCache::TextureCache(ReadOptions options,
                           std::function<std::string(const std::string&)> resolve)
    : options_(std::move(options)), resolve_(std::move(resolve)) {}

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
                                                          const std::string& layer) const {
  auto opened = open(file, layer);
  if (!opened) return std::unexpected(opened.error());
  // The frame is kept whole, even where only a part of it has data.
  const ImageSpec& spec = opened->reader->spec();
  if (double(spec.display.pixels()) * opened->layer.components() * sizeof(float) >
          double(options_.limits.max_bytes) ||
      spec.display.width() < 1 || spec.display.height() < 1)
    return fail(ErrorKind::too_large, file + " is too large for a texture");
  std::vector<std::string> names;
  std::vector<int> order;
  for (const int channel : opened->layer.channels) {
    const std::string& name = spec.channels[static_cast<std::size_t>(channel)].name;
    auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) at = names.insert(names.end(), name);
    order.push_back(static_cast<int>(at - names.begin()));
  }
  auto image = read_image(*opened->reader, options_.limits, names);
  if (!image) return std::unexpected(image.error());
  try {
    return std::make_shared<const Texture>(*image, order);
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
  for (std::int64_t i = 0; i < count; ++i) {
    call.texture->look_up(arguments[0][i], arguments[1][i], call.has_width ? arguments[2][i] : 0.0f,
                          call.filter, call.wrap, value);
    for (std::size_t c = 0; c < n; ++c) results[c][i] = value[c];
  }
}

}  // namespace pse::image
