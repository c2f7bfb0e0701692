// Reading the slices of a stack into blocks.
#include "volume/stack.h"

#include <algorithm>
#include <memory>

#include "image/reader.h"
#include "image/sequence.h"

namespace pse::volume {
namespace {

struct Slices {
  std::vector<std::string> files;  // in order
  image::Layer layer;              // of the first
  image::Window display;
};

Result<image::Layer> choose_layer(const image::ImageReader& reader, const std::string& file,
                                  const std::string& wanted) {
  const auto layers = image::layers_of(reader.spec());
  const image::Layer* found = nullptr;
  if (!wanted.empty())
    found = image::find_layer(layers, wanted);
  else if (layers.size() == 1)
    found = &layers.front();
  else
    found = image::find_layer(layers, "color");
  if (found != nullptr && (found->components() == 1 || found->components() >= 3)) return *found;
  std::string names;
  for (const image::Layer& layer : layers) names += (names.empty() ? "" : ", ") + layer.name;
  return fail(ErrorKind::bad_request, file + " has no layer " +
                                          (wanted.empty() ? "color" : wanted) +
                                          " of 1 or 3 channels; it has " + names);
}

Result<Slices> find_slices(const std::string& pattern, const std::string& layer) {
  Slices slices;
  const std::vector<int> numbers = image::existing_frames(pattern);
  for (const int frame : numbers) slices.files.push_back(*image::frame_name(pattern, frame));
  if (slices.files.empty()) return fail(ErrorKind::not_found, "there are no pictures " + pattern);
  // Every number, or every so many; what else is not there is missing.
  for (std::size_t i = 2; i < numbers.size(); ++i)
    if (numbers[i] - numbers[i - 1] != numbers[1] - numbers[0]) {
      const bool early = numbers[i] - numbers[i - 1] < numbers[1] - numbers[0];
      const int before = early ? numbers[0] : numbers[i - 1];
      return fail(ErrorKind::not_found,
                  "the stack " + pattern + " has a gap: after " +
                      *image::frame_name(pattern, before) + " comes " +
                      *image::frame_name(pattern, early ? numbers[1] : numbers[i]));
    }
  const auto reader = image::open_reader(slices.files.front());
  if (!reader) return std::unexpected(reader.error());
  const auto chosen = choose_layer(**reader, slices.files.front(), layer);
  if (!chosen) return std::unexpected(chosen.error());
  slices.layer = *chosen;
  slices.display = (*reader)->spec().display;
  return slices;
}

int components_of(const image::Layer& layer) { return layer.components() == 1 ? 1 : 3; }

}  // namespace

Result<GridInfo> stack_info(const std::string& pattern, const std::string& layer) {
  const auto slices = find_slices(pattern, layer);
  if (!slices) return std::unexpected(slices.error());
  GridInfo info;
  info.name = slices->layer.name;
  info.type = "pictures";
  info.components = components_of(slices->layer);
  return info;
}

Result<GridData> read_stack(const std::string& pattern, const std::string& layer,
                            std::size_t limit) {
  const auto slices = find_slices(pattern, layer);
  if (!slices) return std::unexpected(slices.error());
  const int width = slices->display.width(), height = slices->display.height();
  const int depth = static_cast<int>(slices->files.size());
  GridData data;
  data.components = components_of(slices->layer);
  const auto n = static_cast<std::size_t>(data.components);
  data.background.assign(n, 0.0f);
  data.even = data.background;
  const std::array<int, 3> voxels = {width, height, depth};
  double blocks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    data.size[a] = (voxels[a] + block_side - 1) / block_side;
    blocks *= data.size[a];
    // Voxel i has its centre at (i + 1/2 - count / 2) / height.
    data.to_index[4 * a + a] = height;
    data.to_index[4 * a + 3] = 0.5 * voxels[a] - 0.5;
  }
  if (blocks * block_voxels * double(n) * sizeof(float) > double(limit) || blocks > 2e9)
    return fail(ErrorKind::too_large, "the stack " + pattern + " takes too much memory");
  data.blocks.resize(static_cast<std::size_t>(blocks));
  for (std::size_t i = 0; i < data.blocks.size(); ++i)
    data.blocks[i] = static_cast<std::int32_t>(i);
  data.voxels.assign(data.blocks.size() * block_voxels * n, 0.0f);

  for (int z = 0; z < depth; ++z) {
    const std::string& file = slices->files[static_cast<std::size_t>(z)];
    const auto reader = image::open_reader(file);
    if (!reader) return std::unexpected(reader.error());
    const image::Window& frame = (*reader)->spec().display;
    if (frame.width() != width || frame.height() != height)
      return fail(ErrorKind::bad_request,
                  "the slices differ in size: " + file + " is " + std::to_string(frame.width()) +
                      "x" + std::to_string(frame.height()) + ", " + slices->files.front() + " " +
                      std::to_string(width) + "x" + std::to_string(height));
    const auto chosen = choose_layer(**reader, file, slices->layer.name);
    if (!chosen) return std::unexpected(chosen.error());
    if (components_of(*chosen) != data.components)
      return fail(ErrorKind::bad_request, "the slices differ in channels: " + file + " has " +
                                              std::to_string(chosen->components()) + " of " +
                                              chosen->name + ", " + slices->files.front() + " " +
                                              std::to_string(slices->layer.components()));
    std::vector<std::string> channels;
    for (const int channel : chosen->channels)
      channels.push_back((*reader)->spec().channels[static_cast<std::size_t>(channel)].name);
    const auto image = image::read_image(**reader, {}, channels);
    if (!image) return std::unexpected(image.error());
    for (std::size_t c = 0; c < n; ++c) {
      const int channel = image->spec.find(channels[std::min(c, channels.size() - 1)]);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          // Rows of a picture run downward.
          const float value = image->at(channel, frame.x0 + x, frame.y0 + height - 1 - y);
          const std::int64_t block =
              (std::int64_t{x >> 3} * data.size[1] + (y >> 3)) * data.size[2] + (z >> 3);
          const std::int64_t voxel = 64 * (x & 7) + 8 * (y & 7) + (z & 7);
          data.voxels[static_cast<std::size_t>(block * block_voxels + voxel) * n + c] = value;
        }
    }
  }
  return data;
}

}  // namespace pse::volume
