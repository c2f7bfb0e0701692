// Names of surfaces for many samples at once: what is computed for them side by side, and where it
// goes. The inner loop of surface_source.cpp, compiled for any processor and for those with AVX2.
#pragma once

#include <cstdint>

#include "surface/scene.h"

namespace pse::surface {

// A sample that sends a ray, and how wide a pixel is where that meets something.
struct Sighting {
  std::uint32_t sample = 0;  // its index in the planes
  double width = 0;          // of a pixel across the ray, metres
  double depth = 0;
};

// What an input may be. Those from `id` on are the same for all samples that show one object.
enum class What : std::uint8_t {
  point,
  place,
  normal,
  flat_normal,
  uv,
  depth,
  backface,
  view,
  origin,
  direction,
  pixelsize,
  pixel_freq,
  dpdx,
  dpdy,
  place_dx,
  place_dy,
  id,
  hit,
  axis_x,
  axis_y,
  axis_z,
  light_direction,
  light_color,
  light_position,
  light_radius
};
inline constexpr std::size_t computed_count = static_cast<std::size_t>(What::id);

// A component of a computed name, or a number that all samples have.
struct NameStore {
  float* out;  // a plane
  What what;
  int component;
  float number;  // where `what` is `id` or after it
};

// Samples that show one object, or the background.
struct NameValues {
  std::size_t count;
  const Sighting* sightings;
  const Ray* rays;
  const Hit* hits;
  const ShapePoint* points;  // the object's at the hits; null: the background, or not wanted
  Frame frame;
  Vec3 right, up;  // the picture's axes
  bool wants_shifts, is_background;
  const NameStore* stores;
  std::size_t store_count;
  float* places[3];  // receive the places of the samples in turn; null: not wanted
};
using NameFunction = void (*)(const NameValues& values);
NameFunction names_for_any();
NameFunction names_for_avx2();
// Which of them the processor wants.
NameFunction name_function();

}  // namespace pse::surface
