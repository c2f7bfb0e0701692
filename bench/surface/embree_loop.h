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

  // The triangle at each pixel of a square picture, or 0xffffffff; single rays or packets of 16 in
  // blocks of 4 by 4.
  std::vector<std::uint32_t> triangles(const Lens& lens, int size, bool packets) const;

 private:
  void* device_;
  void* scene_;
};

}  // namespace pse::surface
