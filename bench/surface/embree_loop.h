// A loop over Embree alone: what primary visibility costs at least.
#pragma once

#include "surface/camera.h"
#include "surface/mesh.h"

namespace pse::surface {

class EmbreeLoop {
 public:
  explicit EmbreeLoop(const Mesh& mesh);
  ~EmbreeLoop();
  EmbreeLoop(const EmbreeLoop&) = delete;
  EmbreeLoop& operator=(const EmbreeLoop&) = delete;

  // The triangle at each pixel of a square picture, or 0xffffffff; rays alone or in packets of 8 or
  // 16, blocks of 4 by 2 or 4 pixels.
  std::vector<std::uint32_t> triangles(const Lens& lens, int size, int packet) const;

 private:
  void* device_;
  void* scene_;
};

}  // namespace pse::surface
