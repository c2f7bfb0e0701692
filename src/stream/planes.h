// Buffers of one batch: an array of floats per name, placed so that kernels may run whole vectors
// over them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pse {

// Each plane starts at a multiple of 64 bytes and holds a multiple of 16 floats; 16 more behind it
// may be read. Planes do not
// start at addresses that are equal or near modulo 4096: there a load would wait for an earlier
// store to another plane.
class Planes {
 public:
  Planes() = default;
  // One plane per entry of `used` that is true, null for the others; room for `capacity` floats
  // each.
  Planes(const std::vector<bool>& used, std::int64_t capacity) { arrange(used, capacity); }
  // Other planes, in the memory that there is where it suffices; what was in it is left there.
  void arrange(const std::vector<bool>& used, std::int64_t capacity);

  std::span<float* const> pointers() const { return pointers_; }
  static std::size_t bytes(const std::vector<bool>& used, std::int64_t capacity);

 private:
  std::vector<float> memory_;
  std::vector<float*> pointers_;
};

}  // namespace pse
