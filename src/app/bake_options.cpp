// Reading the arguments of `pse bake`.
#include "app/bake_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "surface/shape_words.h"

namespace pse::app {
namespace {

constexpr int most_voxels = 16384;  // along one side

// "200": the longest side; "200x100x50": each.
volume::LatticeSize parse_size(const OptionValue& value) {
  volume::LatticeSize size;
  std::vector<int> counts;
  for (const std::string& part : split(value.text, "xX ,"))
    counts.push_back(parse_integer({part, value.origin}, 1, most_voxels));
  if (counts.size() == 1)
    size.longest = counts.front();
  else if (counts.size() == 3)
    size.each = {counts[0], counts[1], counts[2]};
  else
    throw usage_error(fmt::format("{} takes N or NxNxN, not `{}`", value.origin, value.text),
                      "--res 200");
  return size;
}

// Six numbers: the box's lowest and highest corner; one: a cube from -n to n.
volume::Box parse_bounds(const OptionValue& value) {
  const std::vector<double> numbers = parse_numbers(value);
  volume::Box box;
  if (numbers.size() == 1) {
    box.low.fill(-numbers[0]), box.high.fill(numbers[0]);
  } else if (numbers.size() == 6) {
    std::copy_n(numbers.begin(), 3, box.low.begin());
    std::copy_n(numbers.begin() + 3, 3, box.high.begin());
  } else {
    throw usage_error(fmt::format("{} takes 6 numbers, or 1, not `{}`", value.origin, value.text),
                      "--bounds -1,-1,-1,1,1,1");
  }
  for (std::size_t a = 0; a < 3; ++a)
    if (!(box.low[a] < box.high[a]))
      throw usage_error(fmt::format("the box of {} is empty along {}", value.origin, "xyz"[a]),
                        "the lowest corner comes first: x0,y0,z0,x1,y1,z1");
  return box;
}

}  // namespace

VolumeOptions bake_options(const Session& session) {
  VolumeOptions options;
  const Arguments& arguments = session.arguments;
  if (const auto value = arguments.value("res")) options.size = parse_size(*value);
  if (const auto value = arguments.value("bounds")) options.bounds = parse_bounds(*value);
  options.z_up = arguments.text_or("up", "y") == "z";
  if (arguments.has("half") && arguments.has("float"))
    throw usage_error("--half and --float exclude each other");
  options.half = !arguments.has("float");
  if (const auto value = arguments.value("band"))
    options.band = static_cast<float>(parse_number(*value, 1, 1000));
  options.fit = arguments.has("fit");
  // Half of what the machine has.
  const auto machine = static_cast<std::size_t>(std::max(::sysconf(_SC_PHYS_PAGES), 0L)) *
                       static_cast<std::size_t>(std::max(::sysconf(_SC_PAGESIZE), 0L));
  options.memory_limit = std::size_t{8192} << 20;
  if (machine > 0) options.memory_limit = std::min(options.memory_limit, machine / 2);
  if (const auto value = arguments.value("memory"))
    options.memory_limit = static_cast<std::size_t>(parse_integer(*value, 1, 1 << 24)) << 20;

  // The rest means what it means to `pse render`.
  Session rest = session;
  for (const char* own : {"res", "half", "float"}) rest.arguments.options.erase(own);
  options.common = render_options(rest);
  if (options.common.outputs.size() > 1)
    throw usage_error("bake writes one file", "name the grids: -o density,color=cloud.vdb");
  for (const ImageRequest& image : options.common.images)
    if (image.name.empty() &&
        (surface::is_shape_name(image.file) || surface::is_field_name(image.file)))
      throw usage_error(fmt::format("`{}` is no mesh, so it has no texture", image.file),
                        "bake takes meshes with texture coordinates: .obj .ply .gltf .glb");
  if (!options.common.images.empty())
    throw usage_error(fmt::format("a volume has no pixels for `{}`",
                                  options.common.images.front().file),
                      "read it with texture() or volume()");
  return options;
}

}  // namespace pse::app
