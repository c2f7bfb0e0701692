// Looking values up in blocks of voxels.
#include "volume/volume.h"

#include <algorithm>
#include <cmath>

namespace pse::volume {
namespace {

// Places farther out are the background anyway, and index arithmetic stays within integers.
constexpr double far_away = 1e9;

// Where the weight is 0 the other value must not count, even if it is infinite.
float mix(float a, float b, float t) { return t == 0 ? a : a + t * (b - a); }

}  // namespace

Volume::Volume(GridData data) : data_(std::move(data)) {
  const std::int64_t n = data_.components;
  strides_ = {64 * n, 8 * n, n};
}

std::int64_t Volume::block(int x, int y, int z) const {
  const int bx = (x >> 3) - data_.low[0], by = (y >> 3) - data_.low[1], bz = (z >> 3) - data_.low[2];
  if (bx < 0 || by < 0 || bz < 0 || bx >= data_.size[0] || by >= data_.size[1] ||
      bz >= data_.size[2])
    return -1;
  return data_.blocks[static_cast<std::size_t>(
      (std::int64_t{bx} * data_.size[1] + by) * data_.size[2] + bz)];
}

const float* Volume::voxel(std::int64_t block, int x, int y, int z) const {
  if (block < 0) return data_.even.data() + (-1 - block) * data_.components;
  return data_.voxels.data() + block * block_voxels * data_.components + (x & 7) * strides_[0] +
         (y & 7) * strides_[1] + (z & 7) * strides_[2];
}

void Volume::look_up(float px, float py, float pz, float* result) const {
  const auto n = static_cast<std::size_t>(data_.components);
  std::array<int, 3> first{};
  std::array<float, 3> t{};
  const auto& m = data_.to_index;
  for (std::size_t a = 0; a < 3; ++a) {
    const double place =
        m[4 * a] * double{px} + m[4 * a + 1] * double{py} + m[4 * a + 2] * double{pz} + m[4 * a + 3];
    if (!(std::abs(place) < far_away)) {
      std::copy_n(data_.background.data(), n, result);
      return;
    }
    const double floor = std::floor(place);
    first[a] = static_cast<int>(floor);
    t[a] = static_cast<float>(place - floor);
  }

  // The eight voxels around the place; within one block they lie at fixed distances.
  std::array<const float*, 8> corner{};
  const auto& [x, y, z] = first;
  if ((x & 7) != 7 && (y & 7) != 7 && (z & 7) != 7) {
    const std::int64_t here = block(x, y, z);
    const float* base = voxel(here, x, y, z);
    if (here < 0) {
      std::copy_n(base, n, result);
      return;
    }
    for (std::size_t i = 0; i < 8; ++i)
      corner[i] = base + (i & 4 ? strides_[0] : 0) + (i & 2 ? strides_[1] : 0) +
                  (i & 1 ? strides_[2] : 0);
  } else {
    for (int i = 0; i < 8; ++i) {
      const int cx = x + (i >> 2), cy = y + (i >> 1 & 1), cz = z + (i & 1);
      corner[static_cast<std::size_t>(i)] = voxel(block(cx, cy, cz), cx, cy, cz);
    }
  }
  for (std::size_t c = 0; c < n; ++c) {
    const auto along_z = [&](std::size_t i) { return mix(corner[i][c], corner[i + 1][c], t[2]); };
    result[c] = mix(mix(along_z(0), along_z(2), t[1]), mix(along_z(4), along_z(6), t[1]), t[0]);
  }
}

void VolumeCall::run(void* self, std::int64_t count, const float* const* arguments,
                     float* const* results) {
  const Volume& volume = *static_cast<const VolumeCall*>(self)->volume;
  std::array<float, 3> value{};
  for (std::int64_t i = 0; i < count; ++i) {
    volume.look_up(arguments[0][i], arguments[1][i], arguments[2][i], value.data());
    for (std::size_t c = 0; c < static_cast<std::size_t>(volume.components()); ++c)
      results[c][i] = value[c];
  }
}

}  // namespace pse::volume
