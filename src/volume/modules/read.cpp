// VDB files on their way in: what is there, and one grid's voxels in the blocks of volume/vdb.h.
#include <openvdb/io/File.h>

#include <algorithm>
#include <cmath>

#include "volume/modules/parts.h"
#include "volume/modules/structure.h"

namespace pse::volume {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

GridKind kind_of(openvdb::GridClass grid_class) {
  if (grid_class == openvdb::GRID_FOG_VOLUME) return GridKind::fog;
  return grid_class == openvdb::GRID_LEVEL_SET ? GridKind::level_set : GridKind::data;
}

int components_of(const openvdb::GridBase& grid) {
  for (const char* name : {"float", "double", "half", "int32", "int64", "bool"})
    if (grid.valueType() == name) return 1;
  return grid.valueType() == "vec3s" || grid.valueType() == "vec3d" ? 3 : 0;
}

// What OpenVDB says, short and printable: names in a damaged file may be anything.
std::string shortened(const std::string& text) {
  std::string clean;
  for (const char c : text.substr(0, 160))
    if (c >= ' ' && c <= '~' && !(c == ' ' && clean.ends_with(' '))) clean += c;
  return clean;
}

// Opens, runs, and turns what OpenVDB throws into an error that names the file and `part`, what the
// work reads of it.
template <class Work>
auto guarded(const std::string& file, const std::string& part, Work work)
    -> decltype(work(std::declval<openvdb::io::File&>())) {
  if (const auto start = check_structure(file); !start) return std::unexpected(start.error());
  std::string where = "its head";
  try {
    openvdb::io::File in(file);
    in.setCopyMaxBytes(0);
    in.open(false);  // no delayed loading: what is damaged shows here
    where = part;
    return work(in);
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory to read " + file + "; it may be damaged");
  } catch (const std::exception& problem) {
    return fail(ErrorKind::damaged, file + " is damaged or cut off: " + where +
                                        " cannot be read; copy or write the file anew (OpenVDB: " +
                                        shortened(problem.what()) + ")");
  }
}

template <class Value>
void put(const Value& value, float* to) {
  if constexpr (std::is_arithmetic_v<Value>) {
    *to = static_cast<float>(value);
  } else {
    for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(value[c]);
  }
}

int block_of(int voxel) { return voxel >> 3; }

// Copies a tree into blocks.
template <class Grid>
Result<GridData> blocks_of(const Grid& grid, const std::string& file, GridData data,
                           std::size_t limit) {
  const auto& tree = grid.tree();
  const auto n = static_cast<std::size_t>(data.components);
  data.background.resize(n);
  put(grid.background(), data.background.data());
  data.even = data.background;

  // The box of everything that is not background: active voxels and stored blocks.
  CoordBBox box, leaves;
  tree.evalActiveVoxelBoundingBox(box);
  if (tree.evalLeafBoundingBox(leaves)) box.expand(leaves);
  if (box.empty()) return data;
  double count = 1;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    data.low[axis] = block_of(box.min()[a]);
    data.size[axis] = block_of(box.max()[a]) - data.low[axis] + 1;
    count *= data.size[axis];
  }
  const double bytes = count * sizeof(std::int32_t) +
                       double(tree.leafCount()) * block_voxels * double(n) * sizeof(float);
  if (bytes > double(limit) || count > 2e9)
    return fail(ErrorKind::too_large, file + ": grid `" + grid.getName() + "` would take " +
                                          std::to_string(static_cast<long long>(bytes / 1048576)) +
                                          " MiB");

  // Blocks one after the other; neighbours with the same even value share it.
  data.blocks.assign(static_cast<std::size_t>(count), -1);
  data.voxels.reserve(tree.leafCount() * block_voxels * n);
  auto accessor = grid.getConstAccessor();
  std::vector<float> value(n);
  std::size_t at = 0;
  std::int32_t stored = 0;
  for (int x = 0; x < data.size[0]; ++x)
    for (int y = 0; y < data.size[1]; ++y)
      for (int z = 0; z < data.size[2]; ++z, ++at) {
        const Coord place((data.low[0] + x) * block_side, (data.low[1] + y) * block_side,
                          (data.low[2] + z) * block_side);
        if (const auto* leaf = accessor.probeConstLeaf(place)) {
          data.blocks[at] = stored++;
          const std::size_t start = data.voxels.size();
          data.voxels.resize(start + block_voxels * n);
          for (openvdb::Index i = 0; i < block_voxels; ++i)
            put(leaf->getValue(i), &data.voxels[start + i * n]);
          continue;
        }
        put(accessor.getValue(place), value.data());
        const std::size_t last = data.even.size() - n;
        if (std::equal(value.begin(), value.end(), data.background.begin())) continue;
        if (!std::equal(value.begin(), value.end(), data.even.begin() + std::ptrdiff_t(last)))
          data.even.insert(data.even.end(), value.begin(), value.end());
        data.blocks[at] = -static_cast<std::int32_t>(data.even.size() / n);
      }
  return data;
}

Result<GridData> convert(const openvdb::GridBase& grid, const std::string& file,
                         std::size_t limit) {
  GridData data;
  data.components = components_of(grid);
  data.kind = kind_of(grid.getGridClass());
  if (!grid.transform().isLinear())
    return fail(ErrorKind::unsupported,
                file + ": grid `" + grid.getName() + "` lies in a frustum, not in a box");
  const openvdb::Mat4d map =
      grid.transform().baseMap()->getAffineMap()->getMat4().inverse();  // row vectors
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) data.to_index[static_cast<std::size_t>(4 * r + c)] = map[c][r];
  for (const double entry : data.to_index)
    if (!std::isfinite(entry))
      return fail(ErrorKind::damaged, file + ": the transform of `" + grid.getName() + "` is void");

  const auto as = [&]<class Grid>() -> const Grid* { return dynamic_cast<const Grid*>(&grid); };
  if (const auto* g = as.template operator()<openvdb::FloatGrid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::DoubleGrid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::Int32Grid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::Int64Grid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::BoolGrid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::MaskGrid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::Vec3SGrid>())
    return blocks_of(*g, file, data, limit);
  if (const auto* g = as.template operator()<openvdb::Vec3DGrid>())
    return blocks_of(*g, file, data, limit);
  return fail(ErrorKind::bad_request, file + ": grid `" + grid.getName() +
                                          "` holds values of type " + grid.valueType() +
                                          "; numbers and vectors of three can be read");
}

}  // namespace

Result<FileInfo> read_info(const std::string& file) {
  return guarded(file, "the list of its grids", [&](openvdb::io::File& in) -> Result<FileInfo> {
    FileInfo info;
    const auto about = in.getMetadata();
    for (auto meta = about->beginMeta(); meta != about->endMeta(); ++meta)
      info.attributes[meta->first] = meta->second->str();
    const openvdb::GridPtrVecPtr grids = in.readAllGridMetadata();
    for (const auto& grid : *grids) {
      GridInfo one{grid->getName(), grid->valueType(), components_of(*grid),
                   kind_of(grid->getGridClass())};
      const auto low =
          grid->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
      const auto high =
          grid->getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
      const auto count =
          grid->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
      for (int a = 0; a < 3; ++a) {
        if (low) one.low[static_cast<std::size_t>(a)] = low->value()[a];
        if (high) one.high[static_cast<std::size_t>(a)] = high->value()[a];
      }
      if (count) one.active = count->value();
      info.grids.push_back(one);
    }
    return info;
  });
}

Result<GridData> read_grid(const std::string& file, const std::string& name, std::size_t limit) {
  const std::string part = "grid `" + shortened(name) + "`";
  return guarded(file, part, [&](openvdb::io::File& in) -> Result<GridData> {
    if (!in.hasGrid(name))
      return fail(ErrorKind::bad_request, file + " has no grid `" + name + "`");
    const openvdb::GridBase::Ptr grid = in.readGrid(name);
    return convert(*grid, file, limit);
  });
}

}  // namespace pse::volume
