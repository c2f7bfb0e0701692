// Images of named channels: what a file holds, and the same in memory. Pixel (0, 0) is top left, y
// grows downwards. Where it stands: readers (reader.h) and writers (writer.h) speak in these types;
// layers.h turns channels into the named values that a program reads and sets.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pse::image {

// Pixels [x0, x1) x [y0, y1).
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::int64_t pixels() const { return std::int64_t{width()} * height(); }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  // The smallest window that covers both; an empty window covers nothing.
  Window joined(const Window& other) const;
  friend bool operator==(const Window&, const Window&) = default;
};

// How a channel is stored in its file. In memory every channel is float.
enum class PixelType { uint8, uint16, float16, float32, uint32 };

struct Channel {
  std::string
      name;  // as in the file: "R", "N.X", "Z"; of a multi-part file with the part's name in front
  PixelType type = PixelType::float32;
};

// CIE xy of the primaries and of white.
struct Chromaticities {
  std::array<double, 2> red, green, blue, white;
  friend bool operator==(const Chromaticities&, const Chromaticities&) = default;
};

// How the numbers of the colour channels relate to light.
enum class Transfer { linear, srgb, power };

// Premultiplied (associated) alpha is what programs see; PNG stores straight alpha.
enum class Alpha { premultiplied, straight };

struct ImageSpec {
  Window display;  // the frame
  Window data;     // where pixels are stored; may be smaller than the frame, or reach beyond it
  std::vector<Channel> channels;
  Transfer transfer = Transfer::linear;
  float gamma = 2.2f;  // the exponent of Transfer::power
  Alpha alpha = Alpha::premultiplied;
  std::optional<Chromaticities> chromaticities;  // nothing: Rec. 709
  float pixel_aspect = 1;
  double frames_per_second = 0;  // 0: not said
  std::map<std::string, std::string>
      attributes;       // everything else, as text; provenance is "pse/..."
  std::string format;   // "exr", "png", "tiff"...
  std::string storage;  // for people: "zip, scanlines, 2 parts"

  // Index of the channel with this name, or -1.
  int find(std::string_view name) const;
};

// A whole image in memory.
struct Image {
  ImageSpec spec;
  std::vector<std::vector<float>> planes;  // one per channel: the data window, row by row

  Image() = default;
  // All channels 0.
  explicit Image(ImageSpec from);
  // The value at a pixel; 0 outside the data window.
  float at(int channel, int x, int y) const;
  // The place of a pixel of the data window; throws std::out_of_range outside it.
  float& pixel(int channel, int x, int y);
};

std::string_view name_of(PixelType type);

}  // namespace pse::image
