// Channels to layers and back; see layers.h for the rules.
#include "image/layers.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace pse::image {
namespace {

constexpr std::array<std::string_view, 22> colours = {
    "color",    "colour",     "rgb",        "rgba",       "albedo", "diffuse",
    "specular", "emission",   "emissive",   "beauty",     "light",  "lighting",
    "tint",     "ambient",    "reflection", "refraction", "paint",  "sky",
    "flame",    "background", "foreground", "glow"};

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = lower(c);
  return out;
}

// A layer of the file: the channels that share a prefix.
struct Group {
  std::string name;
  std::vector<std::string> suffixes;  // in lower case
  std::vector<std::string> endings;   // as in the file
  std::vector<int> channels;
  std::vector<bool> taken;

  int find(std::string_view suffix) const {
    for (std::size_t i = 0; i < suffixes.size(); ++i)
      if (!taken[i] && suffixes[i] == suffix) return static_cast<int>(i);
    return -1;
  }
};

// Takes the channels with these suffixes out of the group; empty when one is missing.
std::vector<int> take(Group& group, std::span<const std::string> wanted) {
  std::vector<int> found;
  for (const auto& suffix : wanted) {
    const int at = group.find(suffix);
    if (at < 0) return {};
    found.push_back(at);
  }
  for (int& at : found) {
    group.taken[static_cast<std::size_t>(at)] = true;
    at = group.channels[static_cast<std::size_t>(at)];
  }
  return found;
}

// The suffixes that make vectors, longest first where one contains the other.
const std::vector<std::vector<std::string>>& vector_suffixes() {
  static const std::vector<std::vector<std::string>> sets = {{"r", "g", "b", "a"},
                                                             {"r", "g", "b"},
                                                             {"x", "y", "z", "w"},
                                                             {"x", "y", "z"},
                                                             {"u", "v", "w"},
                                                             {"red", "green", "blue", "alpha"},
                                                             {"red", "green", "blue"},
                                                             {"u", "v"},
                                                             {"s", "t"},
                                                             {"x", "y"},
                                                             {"r", "g"}};
  return sets;
}

std::vector<std::string> numbered_suffixes(const Group& group) {
  std::vector<std::string> names;
  while (group.find("c" + std::to_string(names.size() + 1)) >= 0)
    names.push_back("c" + std::to_string(names.size() + 1));
  return names;
}

// Collects layers and keeps their names apart.
struct Collector {
  std::vector<Layer> layers;

  void add(std::string name, std::vector<int> channels, bool colour) {
    std::string free = name;
    for (int n = 2; find_layer(layers, free) != nullptr; ++n) free = name + "_" + std::to_string(n);
    layers.push_back({std::move(free), std::move(channels), colour});
  }
};

void add_root(Group& root, Collector& out) {
  const auto single = [&](const std::string& suffix) { return take(root, std::array{suffix}); };
  const bool has_red = root.find("r") >= 0;
  if (auto rgb = take(root, std::array<std::string, 3>{"r", "g", "b"}); !rgb.empty())
    out.add("color", rgb, true);
  const bool xyz = root.find("x") >= 0 && root.find("z") >= 0;
  if (const int y = root.find("y"); !has_red && !xyz && y >= 0) {
    const int channel = root.channels[static_cast<std::size_t>(y)];
    out.add("color", {channel, channel, channel}, true);
  }
  if (auto a = single("a"); !a.empty()) out.add("alpha", a, false);
  if (auto z = single("z"); !z.empty()) out.add("Z", z, false);
  for (std::size_t i = 0; i < root.channels.size(); ++i)
    if (!root.taken[i]) out.add(variable_name(root.endings[i]), {root.channels[i]}, false);
}

// A table's columns keep their names.
void add_columns(Group& root, Collector& out) {
  for (std::size_t i = 0; i < root.channels.size(); ++i)
    out.add(variable_name(root.endings[i]), {root.channels[i]}, false);
}

void add_group(Group& group, Collector& out) {
  const std::string name = variable_name(group.name);
  if (group.channels.size() == 1) return out.add(name, group.channels, false);

  // The first vector found bears the layer's name; a lone luminance does otherwise.
  bool named = false;
  for (const auto& set : vector_suffixes()) {
    auto found = take(group, set);
    if (found.empty()) continue;
    std::string joined;
    for (const auto& suffix : set) joined += suffix;
    out.add(named ? name + "_" + joined : name, found, set.size() >= 3 && set[0][0] == 'r');
    named = true;
  }
  if (const auto numbered = numbered_suffixes(group); numbered.size() > 1 && !named) {
    out.add(name, take(group, numbered), false);
    named = true;
  }
  if (auto y = named ? std::vector<int>() : take(group, std::array<std::string, 1>{"y"});
      !y.empty())
    out.add(name, y, false);
  for (std::size_t i = 0; i < group.channels.size(); ++i)
    if (!group.taken[i])
      out.add(name + "_" + variable_name(group.endings[i]), {group.channels[i]}, false);
}

// The last word of a variable's name, in lower case, without digits at its end.
std::string last_word(std::string_view name) {
  while (!name.empty() &&
         (std::isdigit(static_cast<unsigned char>(name.back())) || name.back() == '_'))
    name.remove_suffix(1);
  std::size_t start = name.size();
  while (start > 0 && name[start - 1] != '_') {
    --start;
    const bool capital = std::isupper(static_cast<unsigned char>(name[start])) != 0;
    const bool after_small = start > 0 && std::islower(static_cast<unsigned char>(name[start - 1]));
    if (capital && after_small) break;
  }
  return lower(name.substr(start));
}

}  // namespace

std::string variable_name(std::string_view channel) {
  std::string name;
  for (const char c : channel)
    name += std::isalnum(static_cast<unsigned char>(c)) && static_cast<unsigned char>(c) < 128
                ? c
                : '_';
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0]))) name.insert(0, "_");
  return name;
}

std::vector<Layer> layers_of(const ImageSpec& spec) {
  // Channels with the same prefix, in the order of the file.
  std::vector<Group> groups(1);
  for (std::size_t i = 0; i < spec.channels.size(); ++i) {
    const std::string& name = spec.channels[i].name;
    const auto dot = name.rfind('.');
    const std::string prefix = dot == std::string::npos ? "" : name.substr(0, dot);
    const std::string ending = dot == std::string::npos ? name : name.substr(dot + 1);
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& g) { return g.name == prefix; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{prefix, {}, {}, {}, {}});
    group->suffixes.push_back(lower(ending));
    group->endings.push_back(ending);
    group->channels.push_back(static_cast<int>(i));
    group->taken.push_back(false);
  }

  Collector out;
  if (spec.format == "csv" || spec.format == "ply")
    add_columns(groups.front(), out);
  else
    add_root(groups.front(), out);
  for (std::size_t i = 1; i < groups.size(); ++i) add_group(groups[i], out);
  return std::move(out.layers);
}

const Layer* find_layer(std::span<const Layer> layers, std::string_view name) {
  for (const auto& layer : layers)
    if (layer.name == name) return &layer;
  return nullptr;
}

std::span<const std::string_view> colour_words() { return colours; }

bool is_colour_name(std::string_view variable) {
  return std::find(colours.begin(), colours.end(), last_word(variable)) != colours.end();
}

std::vector<OutputChannel> channels_of(const std::string& variable, int components,
                                       const StorageOptions& options) {
  std::vector<OutputChannel> out;
  const auto add = [&](const std::string& name, PixelType type, int component) {
    out.push_back({{name, type}, component});
  };
  const auto add_all = [&](const std::string& prefix, std::string_view letters, PixelType type) {
    for (std::size_t i = 0; i < letters.size(); ++i)
      add(prefix + letters[i], type, components == 1 ? 0 : static_cast<int>(i));
  };

  // The names of the root.
  if ((variable == "color" || variable == "colour") && (components == 1 || components == 3)) {
    add_all("", "RGB", options.colour);
    return out;
  }
  if ((variable == "color" || variable == "colour") && components == 4) {
    add_all("", "RGBA", options.colour);
    return out;
  }
  if (variable == "alpha" && components == 1) {
    add("A", options.colour, 0);
    return out;
  }
  if (variable == "Z" && components == 1) {
    add("Z", options.data, 0);
    return out;
  }

  // Layers.
  const std::string prefix = variable + ".";
  const bool colour = is_colour_name(variable);
  const PixelType type = colour ? options.colour : options.data;
  const std::string word = last_word(variable);
  if (components == 1) {
    add(prefix + "Y", type, 0);
  } else if (components == 2) {
    add_all(prefix, word == "uv" || word == "st" ? "UV" : "XY", type);
  } else if (components == 3) {
    add_all(prefix, colour ? "RGB" : "XYZ", type);
  } else if (components == 4) {
    add_all(prefix, "RGBA", type);
  } else {
    for (int i = 0; i < components; ++i) add(prefix + "c" + std::to_string(i + 1), type, i);
  }
  return out;
}

}  // namespace pse::image
