// The module's one entry: OpenVDB behind the interface of volume/vdb.h.
#include "volume/modules/parts.h"

namespace pse::volume {
namespace {

class Library : public Vdb {
 public:
  Library() { openvdb::initialize(); }

  Result<FileInfo> info(const std::string& file) override { return read_info_aside(file); }
  Result<GridData> read(const std::string& file, const std::string& name,
                        std::size_t limit) override {
    return read_grid_aside(file, name, limit);
  }
  std::unique_ptr<GridWriter> writer(std::vector<GridSpec> grids,
                                     const GridPlace& place) override {
    return make_writer(std::move(grids), place);
  }
  Result<void> add_mesh(GridWriter& to, const MeshView& mesh, float band,
                        const std::function<bool(int, int, int)>& inside,
                        const std::function<bool()>& keep_on) override {
    return add_mesh_to(to, mesh, band, inside, keep_on);
  }
};

}  // namespace
}  // namespace pse::volume

extern "C" pse::volume::Vdb* pse_vdb() {
  static pse::volume::Library library;
  return &library;
}
