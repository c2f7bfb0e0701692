// What pse asks of OpenVDB, in types of its own. modules/ implements it around the library; vdb.cpp
// opens that module when the first grid is read or written, so that programs without volumes do not
// wait for it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "image/error.h"

namespace pse::volume {

using image::ErrorKind;
using image::ImageError;
using image::fail;
using image::Result;

// Blocks of 8 x 8 x 8 voxels are what grids are made of. Voxel (x, y, z) of a block has the index
// 64 x + 8 y + z.
inline constexpr int block_side = 8;
inline constexpr int block_voxels = 512;
// Roughly what a stored block takes while a grid is made, for each component.
inline constexpr std::size_t block_bytes = block_voxels * sizeof(float) + 100;

enum class GridKind {
  fog,        // a density or another quantity; 0 where there is nothing
  level_set,  // a distance to a surface in metres, negative inside, known within a narrow band
  data,       // numbers without such a meaning
};

// A grid to be written.
struct GridSpec {
  std::string name;
  int components = 1;  // 1 or 3
  GridKind kind = GridKind::fog;
  float background = 0;
  bool half = true;  // store 16 bits a number
};

// Places of voxels: voxel (i, j, k) has its centre at origin + voxel * (i, j, k), in metres.
struct GridPlace {
  std::array<double, 3> origin{};
  std::array<double, 3> voxel{1, 1, 1};
};

// What is known of a grid without reading its voxels.
struct GridInfo {
  std::string name;
  std::string type;    // OpenVDB's word for the values: "float", "vec3s"
  int components = 0;  // 0: neither numbers nor vectors of three
  GridKind kind = GridKind::data;
  std::array<int, 3> low{}, high{};  // the voxels with values, both included
  std::int64_t active = 0;           // how many
};

struct FileInfo {
  std::vector<GridInfo> grids;
  std::map<std::string, std::string> attributes;  // of the file; provenance is "pse/..."
};

// The voxels of a grid.
struct GridData {
  int components = 1;
  GridKind kind = GridKind::data;
  std::array<double, 12>
      to_index{};  // rows of the map from metres to voxels: (i j k) = M (x y z 1)
  std::vector<float> background;      // one per component
  std::array<int, 3> low{};           // first block of the box of blocks, in blocks
  std::array<int, 3> size{};          // blocks along each axis
  // One per block of the box, x slowest: >= 0 the index of a stored block, < 0 that of an even one
  // as -1 - index.
  std::vector<std::int32_t> blocks;
  std::vector<float> voxels;  // stored blocks: 512 x components each, components together
  std::vector<float> even;    // values of even blocks: components each; the first is the background
};

// Whether a block is one value, with or without all its voxels, which takes no memory for them.
inline bool is_even(std::span<const float* const> planes,
                    const std::array<std::uint64_t, 8>& active) {
  for (const std::uint64_t word : active)
    if (word != (active[0] == 0 ? std::uint64_t{0} : ~std::uint64_t{0})) return false;
  for (const float* plane : planes)
    for (int i = 1; i < block_voxels; ++i)
      if (plane[i] != plane[0]) return false;
  return true;
}

// Collects the blocks of one file. Blocks of a grid may come in any order; the file does not depend
// on it.
class GridWriter {
 public:
  virtual ~GridWriter() = default;
  // `planes`: the block's voxels, one array of 512 per component; word x of `active` has bit 8 y +
  // z set where the voxel holds a value. `block`: its place in blocks.
  virtual void add(std::size_t grid, const std::array<int, 3>& block,
                   std::span<const float* const> planes,
                   const std::array<std::uint64_t, 8>& active) = 0;
  // Roughly the bytes held.
  virtual std::size_t bytes() const = 0;
  // Fills the inside of level sets and writes the file at `path` directly. `identity`: 36
  // characters that stand for the file (OpenVDB would draw lots).
  virtual Result<void> write(const std::string& path,
                             const std::map<std::string, std::string>& attributes,
                             const std::string& identity) = 0;
};

// A triangle mesh to be turned into distances.
struct MeshView {
  std::span<const std::array<float, 3>> points;
  std::span<const std::array<std::uint32_t, 3>> triangles;
};

// The library. Functions may be called from several threads; errors name `file`.
class Vdb {
 public:
  virtual ~Vdb() = default;
  virtual Result<FileInfo> info(const std::string& file) = 0;
  // All voxels of the grid `name`; `limit`: bytes that it may take.
  virtual Result<GridData> read(const std::string& file, const std::string& name,
                                std::size_t limit) = 0;
  virtual std::unique_ptr<GridWriter> writer(std::vector<GridSpec> grids,
                                             const GridPlace& place) = 0;
  // Makes the signed distances of a mesh, within `band` voxels of its surface, grid 0 of `to`.
  // `inside` tells of voxels whether they are; none: the mesh is closed, and OpenVDB finds out.
  // `keep_on` is asked now and then; false stops with an unfinished result.
  virtual Result<void> add_mesh(GridWriter& to, const MeshView& mesh, float band,
                                const std::function<bool(int, int, int)>& inside,
                                const std::function<bool()>& keep_on) = 0;
};

// The name of a grid as messages show it: names in a file may hold anything.
std::string shown_name(const std::string& name);

// Opens the module. The error says what is missing.
Result<Vdb*> open_vdb();

}  // namespace pse::volume
