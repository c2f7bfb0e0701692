// Inside the OpenVDB module: what its files share.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "volume/vdb.h"

namespace pse::volume {

// The parts of Vdb, one file each. The first two trust the file as far as OpenVDB does.
Result<FileInfo> read_info(const std::string& file);
Result<GridData> read_grid(const std::string& file, const std::string& name, std::size_t limit);
// The same two in a process of its own, with limits of time and memory.
Result<FileInfo> read_info_aside(const std::string& file);
Result<GridData> read_grid_aside(const std::string& file, const std::string& name,
                                 std::size_t limit);
std::unique_ptr<GridWriter> make_writer(std::vector<GridSpec> grids, const GridPlace& place);
Result<void> add_mesh_to(GridWriter& to, const MeshView& mesh, float band,
                         const std::function<bool(int, int, int)>& inside,
                         const std::function<bool()>& keep_on);

// A grid that the writer of this module collects, for add_mesh.
openvdb::FloatGrid& float_grid_of(GridWriter& writer, std::size_t grid);

}  // namespace pse::volume
