// Opening the module around OpenVDB, once.
#include "volume/vdb.h"

#include "image/module_loader.h"

namespace pse::volume {

std::string shown_name(const std::string& name) {
  if (name.empty()) return "(no name)";
  std::string shown;
  for (const char c : name) shown += static_cast<unsigned char>(c) < ' ' || c == 0x7f ? '?' : c;
  return shown;
}

Result<Vdb*> open_vdb() {
  static const Result<Vdb*> vdb = []() -> Result<Vdb*> {
    const auto found = image::load_module("pse_vdb", "pse_vdb");
    if (!found) return std::unexpected(found.error());
    return reinterpret_cast<Vdb* (*)()>(*found)();
  }();
  return vdb;
}

}  // namespace pse::volume
