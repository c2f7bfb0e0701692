// Finding and opening shared modules; see module_loader.h.
#include "image/module_loader.h"

#include <dlfcn.h>

#include <filesystem>
#include <vector>

namespace pse::image {

Result<void*> load_module(const std::string& name, const char* symbol) {
  const std::string file = "lib" + name + ".so";
  std::vector<std::filesystem::path> folders;
  std::error_code ignored;
  if (const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored); !ignored) {
    folders.push_back(self.parent_path());
    folders.push_back(self.parent_path() / "../lib/pse");
    folders.push_back(self.parent_path() / "../lib");
  }
  folders.emplace_back(PSE_MODULE_FOLDER);

  std::string problem = "it was not built";
  for (const auto& folder : folders) {
    const auto path = folder / file;
    if (!std::filesystem::exists(path, ignored)) continue;
    if (void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL))
      if (void* found = ::dlsym(module, symbol)) return found;
    if (const char* said = ::dlerror()) problem = said;
  }
  return fail(ErrorKind::unsupported, "the module " + file + " cannot be opened: " + problem);
}

}  // namespace pse::image
