// Pixels of a G-buffer whose position or normal is no number: other renderers write such where a
// ray was lost. They become background, so that nothing computes with them.
#include <algorithm>
#include <cmath>

#include "surface/gbuffer.h"

namespace pse::surface {
namespace {

struct Channel {
  std::string name;
  std::vector<float>* values;
};

// Channels of a layer that the picture holds.
std::vector<Channel> channels_of(const char* name, image::Image& picture,
                                 const SurfaceLayers& layers, std::span<const image::Layer> all,
                                 const image::ImageSpec& spec) {
  std::vector<Channel> channels;
  const auto layer = layers.find(name);
  if (layer == layers.end()) return channels;
  for (const int channel : image::find_layer(all, layer->second)->channels) {
    const std::string& text = spec.channels[static_cast<std::size_t>(channel)].name;
    if (const int plane = picture.spec.find(text); plane >= 0)
      channels.push_back({text, &picture.planes[static_cast<std::size_t>(plane)]});
  }
  return channels;
}

}  // namespace

std::vector<std::string> clear_broken_pixels(image::Image& picture, const SurfaceLayers& layers,
                                             std::span<const image::Layer> all,
                                             const image::ImageSpec& spec) {
  const auto get = [&](const char* name) {
    return channels_of(name, picture, layers, all, spec);
  };
  // Positions and normals; `point` and `place` may be the same channels.
  std::vector<Channel> checked;
  for (const char* name : {"point", "place", "normal"})
    for (const Channel& channel : get(name))
      if (std::none_of(checked.begin(), checked.end(),
                       [&](const Channel& other) { return other.values == channel.values; }))
        checked.push_back(channel);
  if (checked.empty()) return {};
  // What tells background, in the order in which the source asks.
  const std::vector<Channel> hit = get("hit"), id = get("id"), depth = get("depth");
  const auto shows = [&](std::size_t pixel) {
    if (!hit.empty()) return (*hit.front().values)[pixel] > 0;
    if (!id.empty()) return (*id.front().values)[pixel] > 0;
    return depth.empty() || (*depth.front().values)[pixel] < 1e9f;
  };

  // Count, then clear: a pixel may be broken in several channels.
  std::vector<std::size_t> counts(checked.size());
  std::vector<std::size_t> broken;
  for (std::size_t pixel = 0; pixel < checked.front().values->size(); ++pixel) {
    bool is_broken = false;
    for (std::size_t c = 0; c < checked.size(); ++c) {
      if (std::isfinite((*checked[c].values)[pixel])) continue;
      is_broken = true;
      if (shows(pixel)) ++counts[c];
    }
    if (is_broken) broken.push_back(pixel);
  }
  for (const std::size_t pixel : broken) {
    for (const std::vector<Channel>& channels : {checked, hit, id})
      for (const Channel& channel : channels) (*channel.values)[pixel] = 0;
    for (const Channel& channel : depth) (*channel.values)[pixel] = 1e10f;
  }
  std::vector<std::string> said;
  for (std::size_t c = 0; c < checked.size(); ++c)
    if (counts[c] > 0)
      said.push_back(checked[c].name + " is NaN or infinite at " + std::to_string(counts[c]) +
                     (counts[c] == 1 ? " pixel; it is" : " pixels; they are") +
                     " shown as background");
  return said;
}

}  // namespace pse::surface
