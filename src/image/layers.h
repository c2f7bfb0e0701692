// Between channels of a file and named values of a program.
//
// Reading: R G B is `color`, A is `alpha`, a picture with Y alone is grey: `color` too (and `Y`).
// Of `layer.R .G .B (.A)`, `layer.X .Y .Z (.W)`, `layer.U .V (.W)`, `layer.S .T` and `layer.c1 .c2
// ...` (letters in either case) the vector `layer` is made; a layer of one channel is the number
// `layer`; other channels are numbers `layer_channel`. Root channels that are left keep their
// names: `Z`. Tables' columns without a dot keep theirs too. Signs that a name cannot have become
// `_`: `forward.left.u .v` is `forward_left`.
//
// Writing: `color` is R G B, `alpha` is A, `Z` is Z. Other values are layers named after their
// variable: numbers `.Y`; colours `.R .G .B`; 2 components `.U .V` when the last word of the name
// is uv or st, else `.X .Y`; 3 components
// `.X .Y .Z`, 4 components `.R .G .B .A`, more `.c1 .c2 ...`. A value is a colour when the last
// word of its name is one of colour_words(). Words end at `_`, at a capital, and digits at the end
// do not count: `rimLight2` ends in `light`. Colours and alpha are stored as half, everything else
// as float.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/image.h"

namespace pse::image {

struct Layer {
  std::string name;           // as a program writes it
  std::vector<int> channels;  // of the spec, in the order of the components
  bool colour = false;        // it takes part in colour transforms
  int components() const { return static_cast<int>(channels.size()); }
};

// In the order color, alpha, Z, then as in the file.
std::vector<Layer> layers_of(const ImageSpec& spec);
const Layer* find_layer(std::span<const Layer> layers, std::string_view name);

// A name with every sign that a variable cannot have replaced by `_`.
std::string variable_name(std::string_view channel);

struct StorageOptions {
  PixelType colour = PixelType::float16;
  PixelType data = PixelType::float32;
};

// One channel to be written and the component of the variable that it takes.
struct OutputChannel {
  Channel channel;
  int component = 0;
};
std::vector<OutputChannel> channels_of(const std::string& variable, int components,
                                       const StorageOptions& options = {});

std::span<const std::string_view> colour_words();
bool is_colour_name(std::string_view variable);

}  // namespace pse::image
