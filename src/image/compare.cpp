// Describing and comparing images; see compare.h.
#include "image/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/layers.h"

namespace pse::image {
namespace {

std::string describe(const Window& w) {
  std::string text = std::to_string(w.width()) + " x " + std::to_string(w.height());
  if (w.x0 != 0 || w.y0 != 0)
    text += " from (" + std::to_string(w.x0) + ", " + std::to_string(w.y0) + ")";
  return text;
}

std::string shorter(double value) {
  std::string text = std::to_string(value);
  while (text.ends_with('0')) text.pop_back();
  if (text.ends_with('.')) text.pop_back();
  return text;
}

// |a - b| where NaN equals NaN and an infinity itself.
double distance(float a, float b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  if (!std::isfinite(a) || !std::isfinite(b)) return std::numeric_limits<double>::infinity();
  return std::fabs(double{a} - double{b});
}

// Rows of one image, spread over a common window; what the image's data window does not cover is 0.
class Band {
 public:
  Band(ImageReader& reader, std::vector<int> channels, const Window& common)
      : reader_(reader), channels_(std::move(channels)), common_(common) {
    own_.resize(channels_.size());
    rows_.resize(channels_.size());
  }

  Result<void> read(int y, int count) {
    const Window& data = reader_.spec().data;
    const auto wide = static_cast<std::size_t>(common_.width()),
               narrow = static_cast<std::size_t>(data.width());
    const int first = std::max(y, data.y0), last = std::min(y + count, data.y1);
    std::vector<float*> planes;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      rows_[c].assign(wide * static_cast<std::size_t>(count), 0.0f);
      own_[c].resize(narrow * static_cast<std::size_t>(count));
      planes.push_back(own_[c].data());
    }
    if (first >= last) return {};
    if (auto done = reader_.read_rows(first, last, channels_, planes); !done) return done;
    for (std::size_t c = 0; c < channels_.size(); ++c)
      for (int row = first; row < last; ++row)
        std::copy_n(own_[c].data() + narrow * static_cast<std::size_t>(row - first), narrow,
                    rows_[c].data() + wide * static_cast<std::size_t>(row - y) +
                        static_cast<std::size_t>(data.x0 - common_.x0));
    return {};
  }
  const std::vector<float>& channel(std::size_t c) const { return rows_[c]; }

 private:
  ImageReader& reader_;
  std::vector<int> channels_;
  Window common_;
  std::vector<std::vector<float>> own_, rows_;
};

}  // namespace

std::vector<std::pair<std::string, std::string>> describe(const ImageSpec& spec) {
  std::vector<std::pair<std::string, std::string>> lines;
  lines.emplace_back("format",
                     spec.format + (spec.storage.empty() ? "" : " (" + spec.storage + ")"));
  lines.emplace_back("frame", describe(spec.display));
  if (spec.data != spec.display) lines.emplace_back("data window", describe(spec.data));
  for (const auto& layer : layers_of(spec)) {
    std::string what = layer.components() == 1 ? "number: "
                                               : (layer.colour ? "colour of " : "vector of ") +
                                                     std::to_string(layer.components()) + ": ";
    for (std::size_t i = 0; i < layer.channels.size(); ++i) {
      const auto& channel = spec.channels[static_cast<std::size_t>(layer.channels[i])];
      what += (i == 0 ? "" : " ") + channel.name;
      if (i + 1 == layer.channels.size()) what += " (" + std::string(name_of(channel.type)) + ")";
    }
    lines.emplace_back(layer.name, what);
  }
  if (spec.pixel_aspect != 1) lines.emplace_back("pixel aspect", shorter(spec.pixel_aspect));
  if (spec.frames_per_second > 0)
    lines.emplace_back("frames per second", shorter(spec.frames_per_second));
  if (spec.chromaticities) {
    const auto& c = *spec.chromaticities;
    std::string text;
    for (const auto& p : {c.red, c.green, c.blue, c.white})
      text += (text.empty() ? "" : ", ") + shorter(p[0]) + " " + shorter(p[1]);
    lines.emplace_back("primaries and white", text);
  }
  for (const auto& [name, text] : spec.attributes) lines.emplace_back(name, text);
  return lines;
}

bool Comparison::same() const {
  return shape.empty() && std::all_of(channels.begin(), channels.end(),
                                      [](const auto& channel) { return channel.above == 0; });
}

Result<Comparison> compare(ImageReader& a, ImageReader& b, double tolerance) {
  Comparison result;
  if (a.spec().display != b.spec().display)
    result.shape.push_back("the frames differ: " + describe(a.spec().display) + " and " +
                           describe(b.spec().display));
  for (const auto& channel : b.spec().channels)
    if (a.spec().find(channel.name) < 0)
      result.shape.push_back("only the second has the channel " + channel.name);

  const Window common = a.spec().data.joined(b.spec().data);
  std::vector<int> of_a, of_b;
  for (std::size_t i = 0; i < a.spec().channels.size(); ++i) {
    const std::string& name = a.spec().channels[i].name;
    const int other = b.spec().find(name);
    if (other < 0) {
      result.shape.push_back("only the first has the channel " + name);
      continue;
    }
    of_a.push_back(static_cast<int>(i));
    of_b.push_back(other);
    result.channels.push_back({name, 0, 0, 0, 0, 0});
  }

  constexpr int band = 32;
  std::vector<std::int64_t> finite(of_a.size());
  Band rows_a(a, of_a, common), rows_b(b, of_b, common);
  for (int y = common.y0; y < common.y1; y += band) {
    const int count = std::min(band, common.y1 - y);
    if (auto done = rows_a.read(y, count); !done) return std::unexpected(done.error());
    if (auto done = rows_b.read(y, count); !done) return std::unexpected(done.error());
    for (std::size_t c = 0; c < of_a.size(); ++c) {
      ChannelDifference& found = result.channels[c];
      const auto &va = rows_a.channel(c), &vb = rows_b.channel(c);
      for (std::size_t i = 0; i < va.size(); ++i) {
        const double d = distance(va[i], vb[i]);
        if (d > found.largest) {
          found.largest = d;
          found.x = common.x0 + static_cast<int>(i % static_cast<std::size_t>(common.width()));
          found.y = y + static_cast<int>(i / static_cast<std::size_t>(common.width()));
        }
        if (d > tolerance) ++found.above;
        if (std::isfinite(d)) found.rms += d * d, ++finite[c];
      }
    }
  }
  for (std::size_t c = 0; c < finite.size(); ++c)
    if (finite[c] > 0)
      result.channels[c].rms = std::sqrt(result.channels[c].rms / double(finite[c]));
  return result;
}

}  // namespace pse::image
