// Finding and loading the volumes of a program.
#include "image/sequence.h"
#include "volume/stack.h"
#include "volume/volume.h"

namespace pse::volume {
namespace {

bool is_vdb(const std::string& file) { return file.ends_with(".vdb"); }

}  // namespace

VolumeCache::VolumeCache(std::function<std::string(const std::string&)> resolve, std::size_t limit)
    : resolve_(std::move(resolve)), limit_(limit) {}

// The grid of a VDB file that a name stands for. The lock is held.
Result<GridInfo> VolumeCache::choose(const std::string& file, const std::string& grid) {
  auto head = heads_.find(file);
  if (head == heads_.end()) {
    const auto vdb = open_vdb();
    if (!vdb) return std::unexpected(vdb.error());
    head = heads_.emplace(file, (*vdb)->info(file)).first;
  }
  if (!head->second) return std::unexpected(head->second.error());
  const std::vector<GridInfo>& grids = head->second->grids;
  std::string names;
  for (const GridInfo& there : grids) {
    if (there.name == (grid.empty() ? "density" : grid) || (grid.empty() && grids.size() == 1)) {
      if (there.components > 0) return there;
      return fail(ErrorKind::bad_request, file + ": grid `" + there.name +
                                              "` holds values of type " + there.type +
                                              "; numbers and vectors of three can be read");
    }
    names += (names.empty() ? "" : ", ") + shown_name(there.name);
  }
  if (grids.empty()) return fail(ErrorKind::bad_request, file + " holds no grid");
  return fail(ErrorKind::bad_request, file + " has no grid `" + (grid.empty() ? "density" : grid) +
                                          "`; it has " + names);
}

Result<int> VolumeCache::components(const std::string& file, const std::string& grid) {
  const std::string path = resolve_ ? resolve_(file) : file;
  const std::lock_guard lock(mutex_);
  const auto info = image::is_pattern(path) && !is_vdb(path) ? stack_info(path, grid)
                                                             : choose(path, grid);
  if (!info) return std::unexpected(info.error());
  return info->components;
}

Result<std::shared_ptr<const Volume>> VolumeCache::load(const std::string& file,
                                                        const std::string& grid) {
  const std::lock_guard lock(mutex_);
  if (const auto found = volumes_.find({file, grid}); found != volumes_.end()) return found->second;
  const std::string path = resolve_ ? resolve_(file) : file;
  const auto read = [&]() -> Result<std::shared_ptr<const Volume>> {
    try {
      Result<GridData> data;
      if (image::is_pattern(path) && !is_vdb(path)) {
        data = read_stack(path, grid, limit_);
      } else {
        const auto info = choose(path, grid);
        if (!info) return std::unexpected(info.error());
        data = (*open_vdb())->read(path, info->name, limit_);
      }
      if (!data) return std::unexpected(data.error());
      return std::make_shared<const Volume>(std::move(*data));
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::too_large, "not enough memory for the volume " + file);
    }
  };
  return volumes_.emplace(std::pair(file, grid), read()).first->second;
}

}  // namespace pse::volume
