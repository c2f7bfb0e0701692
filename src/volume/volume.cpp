// Looking values up in blocks of voxels.
#include "volume/volume.h"

#include <algorithm>
#include <cmath>

namespace pse::volume {
namespace {

// Places farther out are the background anyway, and index arithmetic stays within integers.
constexpr double far_away = 1e9;

// Added to the index of a block, it stays below 0 whatever else is added.
constexpr std::int64_t outside = -(std::int64_t{1} << 60);

// Where the weight is 0 the other value must not count, even if it is infinite.
float mix(float a, float b, float t) { return t == 0 ? a : a + t * (b - a); }

}  // namespace

Volume::Volume(GridData data) : data_(std::move(data)) {
  const std::int64_t n = data_.components;
  strides_ = {64 * n, 8 * n, n};
}

std::int64_t Volume::block(int x, int y, int z) const {
  const int bx = (x >> 3) - data_.low[0], by = (y >> 3) - data_.low[1],
            bz = (z >> 3) - data_.low[2];
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
    const double place = m[4 * a] * double{px} + m[4 * a + 1] * double{py} +
                         m[4 * a + 2] * double{pz} + m[4 * a + 3];
    if (!(std::abs(place) < far_away)) {
      std::copy_n(data_.background.data(), n, result);
      return;
    }
    first[a] = static_cast<int>(place);
    if (first[a] > place) --first[a];
    t[a] = static_cast<float>(place - first[a]);
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
      corner[i] =
          base + (i & 4 ? strides_[0] : 0) + (i & 2 ? strides_[1] : 0) + (i & 1 ? strides_[2] : 0);
  } else {
    // Along each axis two voxels, perhaps of two blocks: what each adds to the index of its block,
    // and to that of the voxel within; none: outside the box.
    const std::array<std::int64_t, 3> rows = {std::int64_t{data_.size[1]} * data_.size[2],
                                              data_.size[2], 1};
    std::array<std::array<std::int64_t, 2>, 3> block_part{}, voxel_part{};
    for (std::size_t a = 0; a < 3; ++a)
      for (int k = 0; k < 2; ++k) {
        const int b = ((first[a] + k) >> 3) - data_.low[a];
        const auto at = static_cast<std::size_t>(k);
        block_part[a][at] = b < 0 || b >= data_.size[a] ? outside : b * rows[a];
        voxel_part[a][at] = ((first[a] + k) & 7) * strides_[a];
      }
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t i0 = i >> 2, i1 = i >> 1 & 1, i2 = i & 1;
      const std::int64_t at = block_part[0][i0] + block_part[1][i1] + block_part[2][i2];
      const std::int64_t here = at < 0 ? -1 : data_.blocks[static_cast<std::size_t>(at)];
      corner[i] = here < 0 ? data_.even.data() + (-1 - here) * data_.components
                           : data_.voxels.data() + here * block_voxels * data_.components +
                                 voxel_part[0][i0] + voxel_part[1][i1] + voxel_part[2][i2];
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
