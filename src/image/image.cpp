// The small operations of images in memory; see image.h.
#include "image/image.h"

#include <algorithm>
#include <stdexcept>

namespace pse::image {

Window Window::joined(const Window& other) const {
  if (width() <= 0 || height() <= 0) return other;
  if (other.width() <= 0 || other.height() <= 0) return *this;
  return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1),
          std::max(y1, other.y1)};
}

int ImageSpec::find(std::string_view name) const {
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name == name) return static_cast<int>(i);
  return -1;
}

Image::Image(ImageSpec from) : spec(std::move(from)) {
  planes.assign(spec.channels.size(),
                std::vector<float>(static_cast<std::size_t>(spec.data.pixels()), 0.0f));
}

namespace {

std::size_t index_of(const Window& data, int x, int y) {
  return static_cast<std::size_t>(std::int64_t{y - data.y0} * data.width() + (x - data.x0));
}

}  // namespace

float Image::at(int channel, int x, int y) const {
  if (!spec.data.contains(x, y)) return 0;
  return planes[static_cast<std::size_t>(channel)][index_of(spec.data, x, y)];
}

float& Image::pixel(int channel, int x, int y) {
  if (!spec.data.contains(x, y)) throw std::out_of_range("pixel outside the data window");
  return planes.at(static_cast<std::size_t>(channel))[index_of(spec.data, x, y)];
}

std::string_view name_of(PixelType type) {
  switch (type) {
    case PixelType::uint8:
      return "uint8";
    case PixelType::uint16:
      return "uint16";
    case PixelType::float16:
      return "half";
    case PixelType::float32:
      return "float";
    case PixelType::uint32:
      return "uint";
  }
  return "?";
}

}  // namespace pse::image
