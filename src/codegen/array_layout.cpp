// Offsets of arrays: see the header.
#include "codegen/array_layout.h"

namespace pse {

FrameArrayLayout::FrameArrayLayout(const std::vector<ir::Array>& arrays) {
  for (const ir::Array& array : arrays) {
    if (array.rate == ir::Rate::sample) {
      offset.push_back(-1);
      continue;
    }
    offset.push_back(size);
    size += std::int64_t{array.components} * array.capacity;
  }
}

SampleArrayLayout::SampleArrayLayout(const std::vector<ir::Array>& arrays, int width) {
  for (const ir::Array& array : arrays) {
    if (array.rate != ir::Rate::sample) {
      offset.push_back(-1);
      continue;
    }
    offset.push_back(size);
    size += (std::int64_t{array.capacity} + 1) * array.components * width;
  }
}

}  // namespace pse
