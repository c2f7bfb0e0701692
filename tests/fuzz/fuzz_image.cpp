// libFuzzer: any bytes as an EXR or PNG file. The reader must refuse them or give an image, within
// small limits on memory, without a crash or a hang. Rows read one by one are those of the whole.
// Other formats are OpenImageIO's and are not tried here.
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "image/compare.h"
#include "image/exr_header.h"
#include "image/layers.h"
#include "image/png_reader.h"
#include "image/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pse::image;
  ReadOptions options;
  options.limits.max_pixels = 1 << 18;
  options.limits.max_bytes = 1 << 25;
  options.limits.max_band_bytes = 1 << 25;
  options.limits.max_channels = 64;
  if (size > 0 && data[size - 1] % 2 == 0) options.working.reset();

  const Bytes bytes = bytes_from_memory("the file", std::vector<unsigned char>(data, data + size));
  if (!is_exr(*bytes) && !is_png(*bytes)) return 0;
  auto reader = open_reader(bytes, options);
  if (!reader) {
    if (reader.error().message.empty()) std::abort();
    return 0;
  }
  describe((*reader)->spec());
  if (layers_of((*reader)->spec()).empty()) std::abort();
  const auto whole = read_image(**reader, options.limits);

  // Rows read one at a time, backwards, are those of the whole. Not so of damaged EXR files, where
  // a chunk is found by its neighbour in one order and by a broken table in the other.
  const bool strict = whole && (*reader)->spec().format == "png";
  const Window& window = (*reader)->spec().data;
  const auto width = static_cast<std::size_t>(window.width());
  const std::vector<int> first = {0};
  std::vector<float> row(width);
  const std::vector<float*> plane = {row.data()};
  for (int y = window.y1 - 1; y >= window.y0 && y >= window.y1 - 20; --y) {
    const bool good = (*reader)->read_rows(y, y + 1, first, plane).has_value();
    if (!strict) continue;
    const float* same = whole->planes[0].data() + static_cast<std::size_t>(y - window.y0) * width;
    if (!good || std::memcmp(row.data(), same, width * sizeof(float)) != 0) std::abort();
  }
  return 0;
}
