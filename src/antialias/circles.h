// Edges that bend within the kernel's reach: circles, found from the normals at some places around.
#pragma once

namespace pse::antialias {

// In pixels from a pixel's centre.
struct Circle {
  float x = 0, y = 0, radius = 0;
  bool grows = true;  // what is compared grows outward: the normals point away from the middle
};

}  // namespace pse::antialias
