// From a SplitModule to a kernel: the cache first, LLVM only if that has nothing.
// The whole of code generation reads here.
#include <chrono>

#include "codegen/backend.h"
#include "codegen/code_object.h"
#include "codegen/compiled_kernel.h"
#include "codegen/kernel_cache.h"
#include "codegen/module_hash.h"
#include "codegen/target.h"
#include "ir/count.h"

namespace pse {
namespace {

// With all tables in registers a small program runs up to a third faster when two vectors overlap;
// it takes twice as long to compile, so a large one does not. docs/decisions/2026-11-22-kernels.md
// has the numbers.
int best_width(const ir::Module& module, const Target& target) {
  constexpr std::size_t small = 320;
  return target.vbmi && ir::count_instructions(module) <= small ? 2 * target.width : target.width;
}

std::expected<BackendRequest, std::string> make_request(const passes::SplitModule& split,
                                                        const CodegenOptions& options) {
  const Target* target = find_target(options.cpu);
  if (!target) {
    if (options.cpu.empty())
      return std::unexpected(std::string("compiled code needs a processor with SSE 4.2"));
    std::string known;
    for (const Target& t : targets) known += (known.empty() ? "" : ", ") + std::string(t.name);
    return std::unexpected("there is no processor level '" + options.cpu + "'; known are " + known);
  }
  const int width = options.width == 0 ? best_width(split.module, *target) : options.width;
  if (width != 1 && width != 4 && width != 8 && width != 16 && width != 32) {
    return std::unexpected("a vector cannot have " + std::to_string(width) +
                           " samples; 1, 4, 8, 16 and 32 are possible");
  }
  BackendRequest request;
  request.split = &split;
  request.target = target;
  request.width = width;
  request.optimize = options.optimize;
  return request;
}

// Everything that decides the code. The compiler itself is known by its file's size and time.
Hash128 key_of(const BackendRequest& request) {
  Hasher hasher;
  hasher.add("pse kernel 1");
  std::error_code error;
  const auto path = backend_path();
  hasher.add(std::filesystem::file_size(path, error));
  hasher.add(std::filesystem::last_write_time(path, error).time_since_epoch().count());
  hasher.add(request.target->name);
  hasher.add(request.width);
  hasher.add(request.optimize);
  hash_program(hasher, *request.split);
  return hasher.finish();
}

std::unique_ptr<Kernel> load(const BackendRequest& request, const std::string& object) {
  auto code = CodeObject::load(std::as_bytes(std::span(object)));
  if (!code) return nullptr;
  return CompiledKernel::make(*request.split, std::move(*code), request.width);
}

}  // namespace

std::expected<std::unique_ptr<Kernel>, std::string> compile_kernel(const passes::SplitModule& split,
                                                                   const CodegenOptions& options,
                                                                   CodegenStats* stats) {
  const auto start = std::chrono::steady_clock::now();
  const auto request = make_request(split, options);
  if (!request) return std::unexpected(request.error());
  if (request->target > host_target()) {
    return std::unexpected("this processor cannot run code for " +
                           std::string(request->target->name));
  }
  const KernelCache cache(options.cache);
  const Hash128 key = options.cache.empty() ? Hash128{} : key_of(*request);

  std::unique_ptr<Kernel> kernel;
  if (const auto cached = cache.find(key)) kernel = load(*request, *cached);
  const bool from_cache = kernel != nullptr;
  if (!kernel) {
    const auto object = run_backend(*request);
    if (!object) return std::unexpected(object.error());
    kernel = load(*request, *object);
    if (!kernel) return std::unexpected(std::string("the compiled code cannot be loaded"));
    cache.keep(key, *object);
  }
  if (stats) {
    stats->seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats->from_cache = from_cache;
    stats->width = request->width;
    stats->cpu = request->target->name;
  }
  return kernel;
}

std::expected<std::string, std::string> emit_listing(const passes::SplitModule& split,
                                                     const CodegenOptions& options,
                                                     Listing listing) {
  auto request = make_request(split, options);
  if (!request) return std::unexpected(request.error());
  request->product = listing == Listing::llvm ? BackendProduct::llvm : BackendProduct::assembly;
  return run_backend(*request);
}

}  // namespace pse
