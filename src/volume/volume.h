// A grid looked up at any place: `volume("cloud.vdb", p)` of the language. Between the centres of
// voxels the value is linear along each axis; outside the grid it is the grid's background. The
// result depends on nothing but the arguments, so it has the same bits in batches of any size.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "codegen/kernel.h"
#include "volume/vdb.h"

namespace pse::volume {

class Volume {
 public:
  explicit Volume(GridData data);

  int components() const { return data_.components; }
  const GridData& data() const { return data_; }
  // At a place in metres. Where a coordinate is NaN or infinite: the background.
  void look_up(float x, float y, float z, float* result) const;

 private:
  // The block that a voxel lies in, as in GridData::blocks; outside all, the background's.
  std::int64_t block(int x, int y, int z) const;
  const float* voxel(std::int64_t block, int x, int y, int z) const;

  GridData data_;
  std::array<std::int64_t, 3> strides_{};  // in voxels, within a block
};

// One volume() of a program, as a function of the host for the kernel: arguments x, y, z.
struct VolumeCall {
  std::shared_ptr<const Volume> volume;
  static void run(void* self, std::int64_t count, const float* const* arguments,
                  float* const* results);
};

// Volumes by file and grid, each loaded once. Files are VDB, or a pattern that stands for the
// pictures of a stack (stack.h).
class VolumeCache {
 public:
  // `resolve` turns a program's file name into a path; `limit`: bytes that one volume may take.
  explicit VolumeCache(std::function<std::string(const std::string&)> resolve,
                       std::size_t limit = std::size_t{8} << 30);

  // An empty grid name: the only grid, or the one called `density`.
  Result<std::shared_ptr<const Volume>> load(const std::string& file, const std::string& grid);
  // How many components that grid has; looks only at the file's head.
  Result<int> components(const std::string& file, const std::string& grid);

 private:
  Result<GridInfo> choose(const std::string& file, const std::string& grid);

  std::function<std::string(const std::string&)> resolve_;
  std::size_t limit_;
  std::mutex mutex_;
  std::map<std::pair<std::string, std::string>, Result<std::shared_ptr<const Volume>>> volumes_;
  std::map<std::string, Result<FileInfo>> heads_;
};

}  // namespace pse::volume
