// Finding and opening the LLVM module.
#include "codegen/backend.h"

#include <dlfcn.h>

#include <system_error>
#include <vector>

namespace pse {
namespace {

constexpr const char* file_name = "libpse_llvm.so";

// The folder of the program or shared library that this code was linked into.
std::filesystem::path own_folder() {
  Dl_info found{};
  if (dladdr(reinterpret_cast<const void*>(&backend_path), &found) == 0 || !found.dli_fname)
    return {};
  std::error_code error;
  // For the main program dli_fname is argv[0], which need not be a path.
  std::filesystem::path file = found.dli_fname;
  if (!file.is_absolute()) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) file = program;
  }
  const auto real = std::filesystem::canonical(file, error);
  return error ? file.parent_path() : real.parent_path();
}

std::expected<BackendEntry, std::string> backend_entry() {
  const std::filesystem::path path = backend_path();
  if (path.empty())
    return std::unexpected(std::string("the compiler module ") + file_name + " was not found");
  // Never closed: LLVM does not unload.
  void* handle = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (!handle)
    return std::unexpected(std::string("the compiler module does not load: ") + dlerror());
  const auto entry = reinterpret_cast<BackendEntry>(dlsym(handle, backend_symbol));
  if (!entry)
    return std::unexpected("the compiler module " + path.string() + " is of another version");
  return entry;
}

}  // namespace

std::filesystem::path backend_path() {
  const std::filesystem::path folder = own_folder();
  std::vector<std::filesystem::path> candidates = {
      folder / file_name, folder / ".." / "lib" / "pse" / file_name, folder / "pse" / file_name};
#ifdef PSE_LLVM_BUILT_AT
  candidates.emplace_back(PSE_LLVM_BUILT_AT);
#endif
  std::error_code error;
  for (const auto& candidate : candidates) {
    if (std::filesystem::is_regular_file(candidate, error)) return candidate;
  }
  return {};
}

void open_backend() { (void)backend_entry(); }

std::expected<std::string, std::string> run_backend(const BackendRequest& request) {
  const auto entry = backend_entry();
  if (!entry) return std::unexpected(entry.error());
  BackendReply reply;
  (*entry)(&request, &reply);
  if (!reply.error.empty()) return std::unexpected(reply.error);
  return std::move(reply.bytes);
}

}  // namespace pse
