// Grids on their way into a VDB file.
#include <openvdb/io/File.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <bit>
#include <fstream>

#include "volume/modules/parts.h"
#include "volume/modules/structure.h"

namespace pse::volume {
namespace {

using openvdb::Coord;

constexpr int identity_length = 36;
// Magic number, file version, library version (two words), whether there are grid offsets.
constexpr std::streamoff identity_place = 8 + 4 + 4 + 4 + 1;

openvdb::math::Transform::Ptr transform_of(const GridPlace& place) {
  openvdb::math::MapBase::Ptr map;
  const auto& v = place.voxel;
  const openvdb::Vec3d origin(place.origin.data());
  if (v[0] == v[1] && v[1] == v[2])
    map = std::make_shared<openvdb::math::UniformScaleTranslateMap>(v[0], origin);
  else
    map = std::make_shared<openvdb::math::ScaleTranslateMap>(openvdb::Vec3d(v.data()), origin);
  return std::make_shared<openvdb::math::Transform>(map);
}

openvdb::GridClass class_of(GridKind kind) {
  if (kind == GridKind::fog) return openvdb::GRID_FOG_VOLUME;
  return kind == GridKind::level_set ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN;
}

template <class Grid>
typename Grid::ValueType value_at(std::span<const float* const> planes, std::size_t voxel) {
  if constexpr (std::is_same_v<Grid, openvdb::Vec3SGrid>)
    return {planes[0][voxel], planes[1][voxel], planes[2][voxel]};
  else
    return planes[0][voxel];
}

// True where the block takes memory for its voxels.
template <class Grid>
bool add_block(Grid& grid, const std::array<int, 3>& block, std::span<const float* const> planes,
               const std::array<std::uint64_t, 8>& active) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  static_assert(Leaf::SIZE == block_voxels);
  const Coord origin(block[0] * block_side, block[1] * block_side, block[2] * block_side);
  const typename Grid::ValueType first = value_at<Grid>(planes, 0);

  // An even block is one tile and needs no memory for its voxels.
  if (is_even(planes, active)) {
    if (active[0] != 0 || first != grid.background())
      grid.tree().addTile(1, origin, first, active[0] != 0);
    return false;
  }

  auto* leaf = new Leaf(origin, grid.background(), false);
  for (openvdb::Index i = 0; i < block_voxels; ++i)
    leaf->setValueOnly(i, value_at<Grid>(planes, i));
  for (int x = 0; x < block_side; ++x)
    for (int bit = 0; bit < 64; ++bit)
      if ((active[static_cast<std::size_t>(x)] >> bit & 1) != 0)
        leaf->setValueOn(static_cast<openvdb::Index>(64 * x + bit));
  grid.tree().addLeaf(leaf);
  return true;
}

class Writer : public GridWriter {
 public:
  Writer(std::vector<GridSpec> specs, const GridPlace& place) : specs_(std::move(specs)) {
    for (const GridSpec& spec : specs_) {
      openvdb::GridBase::Ptr grid;
      if (spec.components == 3) {
        auto made = openvdb::Vec3SGrid::create(openvdb::Vec3s(spec.background));
        made->setVectorType(openvdb::VEC_INVARIANT);
        grid = made;
      } else {
        grid = openvdb::FloatGrid::create(spec.background);
      }
      grid->setName(spec.name);
      grid->setCreator("pse");
      grid->setGridClass(class_of(spec.kind));
      grid->setSaveFloatAsHalf(spec.half);
      grid->setTransform(transform_of(place));
      grids_.push_back(grid);
    }
  }

  void add(std::size_t grid, const std::array<int, 3>& block, std::span<const float* const> planes,
           const std::array<std::uint64_t, 8>& active) override {
    const auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grids_[grid]);
    const bool stored = scalar ? add_block(*scalar, block, planes, active)
                               : add_block(*openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids_[grid]),
                                           block, planes, active);
    if (stored) bytes_ += block_bytes * planes.size();
  }

  std::size_t bytes() const override { return bytes_; }

  Result<void> write(const std::string& path, const std::map<std::string, std::string>& attributes,
                     const std::string& identity) override {
    try {
      for (std::size_t i = 0; i < grids_.size(); ++i) finish(i);
      openvdb::MetaMap about;
      for (const auto& [name, text] : attributes)
        about.insertMeta(name, openvdb::StringMetadata(text));
      openvdb::io::File file(path);
      file.setCompression(openvdb::io::File::hasBloscCompression()
                              ? openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK
                              : openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
      file.write(grids_, about);
      file.close();
      // OpenVDB does not tell of a disk that is full; the file then ends too early.
      if (!check_structure(path)) return fail(ErrorKind::cannot_write, "the file came out damaged");
      return set_identity(path, identity);
    } catch (const std::exception& problem) {
      return fail(ErrorKind::cannot_write, problem.what());
    }
  }

  openvdb::FloatGrid& scalar(std::size_t grid) {
    return *openvdb::gridPtrCast<openvdb::FloatGrid>(grids_[grid]);
  }

 private:
  // Merges even blocks into larger ones; gives the inside of a level set its sign.
  void finish(std::size_t i) {
    if (auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grids_[i])) {
      if (specs_[i].kind == GridKind::level_set) openvdb::tools::signedFloodFill(scalar->tree());
      openvdb::tools::prune(scalar->tree());
    } else {
      openvdb::tools::prune(openvdb::gridPtrCast<openvdb::Vec3SGrid>(grids_[i])->tree());
    }
  }

  // OpenVDB draws a number for each file; the same grids shall give the same bytes.
  static Result<void> set_identity(const std::string& path, const std::string& identity) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(identity_place);
    file.write(identity.data(), identity_length);
    file.flush();
    if (!file) return fail(ErrorKind::cannot_write, "the file cannot be completed");
    return {};
  }

  std::vector<GridSpec> specs_;
  openvdb::GridPtrVec grids_;
  std::size_t bytes_ = 0;
};

}  // namespace

std::unique_ptr<GridWriter> make_writer(std::vector<GridSpec> grids, const GridPlace& place) {
  return std::make_unique<Writer>(std::move(grids), place);
}

openvdb::FloatGrid& float_grid_of(GridWriter& writer, std::size_t grid) {
  return static_cast<Writer&>(writer).scalar(grid);
}

}  // namespace pse::volume
