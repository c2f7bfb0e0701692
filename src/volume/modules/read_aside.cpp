// VDB files read in a child process, between module.cpp and read.cpp: OpenVDB believes what a file
// says of its trees, so a damaged one may make it break down, wait or allocate without end. It does
// so there.
#include <algorithm>
#include <filesystem>

#include "base/side_process.h"
#include "volume/modules/parts.h"

namespace pse::volume {
namespace {

using side::get;
using side::get_all;
using side::put;
using side::put_all;

bool send(int to, const FileInfo& info) {
  const std::uint64_t grids = info.grids.size(), attributes = info.attributes.size();
  bool sent = put(to, &grids, sizeof grids) && put(to, &attributes, sizeof attributes);
  for (const GridInfo& grid : info.grids)
    sent = sent && put_all(to, grid.name) && put_all(to, grid.type) &&
           put(to, &grid.components, sizeof grid.components) &&
           put(to, &grid.kind, sizeof grid.kind) && put(to, &grid.low, sizeof grid.low) &&
           put(to, &grid.high, sizeof grid.high) && put(to, &grid.active, sizeof grid.active);
  for (const auto& [name, value] : info.attributes)
    sent = sent && put_all(to, name) && put_all(to, value);
  return sent;
}

bool receive(int from, FileInfo& info) {
  std::uint64_t grids = 0, attributes = 0;
  if (!get(from, &grids, sizeof grids) || !get(from, &attributes, sizeof attributes)) return false;
  for (std::uint64_t i = 0; i < grids; ++i) {
    GridInfo grid;
    if (!get_all(from, grid.name) || !get_all(from, grid.type) ||
        !get(from, &grid.components, sizeof grid.components) ||
        !get(from, &grid.kind, sizeof grid.kind) || !get(from, &grid.low, sizeof grid.low) ||
        !get(from, &grid.high, sizeof grid.high) || !get(from, &grid.active, sizeof grid.active))
      return false;
    info.grids.push_back(std::move(grid));
  }
  for (std::uint64_t i = 0; i < attributes; ++i) {
    std::string name, value;
    if (!get_all(from, name) || !get_all(from, value)) return false;
    info.attributes.emplace(std::move(name), std::move(value));
  }
  return true;
}

bool send(int to, const GridData& data) {
  return put(to, &data.components, sizeof data.components) &&
         put(to, &data.kind, sizeof data.kind) && put(to, &data.to_index, sizeof data.to_index) &&
         put(to, &data.low, sizeof data.low) && put(to, &data.size, sizeof data.size) &&
         put_all(to, data.background) && put_all(to, data.blocks) && put_all(to, data.voxels) &&
         put_all(to, data.even);
}

// Whether every block that the box names is there.
bool agrees(const GridData& data) {
  if (data.components != 1 && data.components != 3) return false;
  const auto n = static_cast<std::size_t>(data.components);
  double count = 1;
  for (const int side : data.size) count *= std::max(side, 0);
  if (double(data.blocks.size()) != count || data.background.size() != n) return false;
  const auto stored = static_cast<std::int64_t>(data.voxels.size() / (n * block_voxels));
  const auto even = static_cast<std::int64_t>(data.even.size() / n);
  return std::all_of(data.blocks.begin(), data.blocks.end(),
                     [&](std::int64_t block) { return block < stored && block >= -even; });
}

bool receive(int from, GridData& data) {
  constexpr std::uint64_t most = std::uint64_t{1} << 32;
  return get(from, &data.components, sizeof data.components) &&
         get(from, &data.kind, sizeof data.kind) &&
         get(from, &data.to_index, sizeof data.to_index) && get(from, &data.low, sizeof data.low) &&
         get(from, &data.size, sizeof data.size) && get_all(from, data.background) &&
         get_all(from, data.blocks, most) && get_all(from, data.voxels, most) &&
         get_all(from, data.even, most) && agrees(data);
}

// What `read` returns, by way of another process. A voxel of a grid takes at least a bit of the
// file, so memory and time that are far beyond the file's size are a sign of damage.
template <class Value, class Read>
Result<Value> aside(const std::string& file, Read read) {
  constexpr rlim_t gibibyte = rlim_t{1} << 30;
  std::error_code none;
  const auto found = std::filesystem::file_size(file, none);
  const rlim_t bytes = none ? 0 : static_cast<rlim_t>(found);
  Value value;
  ImageError problem;
  const auto work = [&](int pipe) {
    const Result<Value> result = read();
    if (!result) problem = result.error();
    return put(pipe, &problem.kind, sizeof problem.kind) && put_all(pipe, problem.message) &&
           (!result || send(pipe, *result));
  };
  const auto take = [&](int pipe) {
    return get(pipe, &problem.kind, sizeof problem.kind) && get_all(pipe, problem.message) &&
           (!problem.message.empty() || receive(pipe, value));
  };
  switch (side::run(side::mapped() + gibibyte + 256 * bytes, 20 + 2 * (bytes >> 20), work, take)) {
    case side::Ended::whole:
      break;
    case side::Ended::not_started:
      return fail(ErrorKind::cannot_read, "cannot read " + file + ": no process can be started");
    case side::Ended::took_too_long:
      return fail(ErrorKind::damaged, file +
                                          " is damaged or cut off: reading it takes longer than a "
                                          "file of its size may; copy or write it anew");
    case side::Ended::broke_down:
      return fail(ErrorKind::damaged, file +
                                          " is damaged or cut off: its reader broke down; copy or "
                                          "write the file anew");
  }
  if (!problem.message.empty()) return std::unexpected(problem);
  return value;
}

}  // namespace

Result<FileInfo> read_info_aside(const std::string& file) {
  return aside<FileInfo>(file, [&] { return read_info(file); });
}

Result<GridData> read_grid_aside(const std::string& file, const std::string& name,
                                 std::size_t limit) {
  return aside<GridData>(file, [&] { return read_grid(file, name, limit); });
}

}  // namespace pse::volume
