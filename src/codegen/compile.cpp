// From a SplitModule to a kernel: the cache first, LLVM only if that has nothing.
// The whole of code generation reads here.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "codegen/backend.h"
#include "codegen/code_object.h"
#include "codegen/compiled_kernel.h"
#include "codegen/first/first_kernel.h"
#include "codegen/frame_code.h"
#include "codegen/kernel_cache.h"
#include "codegen/module_hash.h"
#include "codegen/object_bundle.h"
#include "codegen/target.h"
#include "codegen/uniformity.h"
#include "ir/count.h"

namespace pse {
namespace {

// Two vectors that overlap hide each other's waiting, but take longer to compile: for a
// small program where all tables are in registers, and for one whose samples leave loops at
// different turns, which is long chains of dependent steps. docs/decisions/2026-11-22-kernels.md
// and 2026-11-29-squares-of-rays.md have the numbers.
int best_width(const passes::SplitModule& split, const Target& target) {
  constexpr std::size_t small = 320;
  const bool is_small = target.vbmi && ir::count_instructions(split.module) <= small;
  return is_small || (target.avx2 && has_varying_loops(split)) ? 2 * target.width : target.width;
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
  const int width = options.width == 0 ? best_width(split, *target) : options.width;
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
  hasher.add("pse kernel 2");
  std::error_code error;
  const auto path = backend_path();
  hasher.add(std::filesystem::file_size(path, error));
  hasher.add(std::filesystem::last_write_time(path, error).time_since_epoch().count());
  hasher.add(request.target->name);
  hasher.add(request.width);
  hasher.add(request.optimize);
  hasher.add(request.part);
  hash_program(hasher, *request.split);
  return hasher.finish();
}

// Two pieces at once take little more than half the time; a small program is sooner done in one.
// The machine does not matter: what is kept is the same everywhere.
int pieces_of(const BackendRequest& request) {
  constexpr std::size_t large = 350;
  if (request.part == BackendPart::frame) return 1;
  const ir::Module& module = request.split->module;
  const std::size_t frame = ir::count_instructions(module.functions[request.split->frame]);
  return ir::count_instructions(module) - frame > large ? 2 : 1;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::expected<std::string, std::string> make_objects(BackendRequest request, double& behind) {
  request.pieces = pieces_of(request);
  std::vector<double> seconds(static_cast<std::size_t>(request.pieces));
  std::vector<std::expected<std::string, std::string>> made(
      static_cast<std::size_t>(request.pieces));
  const auto make = [&](int piece) {
    BackendRequest mine = request;
    mine.piece = piece;
    const double start = thread_seconds();
    made[static_cast<std::size_t>(piece)] = run_backend(mine);
    seconds[static_cast<std::size_t>(piece)] = thread_seconds() - start;
  };
  {
    std::vector<std::jthread> others;
    for (int piece = 1; piece < request.pieces; ++piece) others.emplace_back(make, piece);
    make(0);
  }
  behind = std::ranges::max(seconds) - seconds[0];
  std::vector<std::string> objects;
  for (auto& object : made) {
    if (!object) return std::unexpected(object.error());
    objects.push_back(std::move(*object));
  }
  return bundle(objects);
}

struct Made {
  CodeObject code;
  bool from_cache = false;
  double behind = 0;
};

// The code of one entry point.
std::expected<Made, std::string> code_of(const BackendRequest& request, const KernelCache& cache,
                                         bool only_cached = false) {
  const Hash128 key = cache.keeps() ? key_of(request) : Hash128{};
  if (const auto cached = cache.find(key)) {
    if (auto code = CodeObject::load(unbundle(*cached))) return Made{std::move(*code), true, 0};
  }
  if (only_cached) return std::unexpected(std::string("the cache has no such kernel"));
  double behind = 0;
  const auto objects = make_objects(request, behind);
  if (!objects) return std::unexpected(objects.error());
  auto code = CodeObject::load(unbundle(*objects));
  if (!code) return std::unexpected(code.error());
  cache.keep(key, *objects);
  return Made{std::move(*code), false, behind};
}

std::unique_ptr<const FrameCode> frame_code(const BackendRequest& request, const KernelCache& cache,
                                            bool at_once) {
  const auto compile = [cache,
                        request](const passes::SplitModule& part) -> std::optional<CodeObject> {
    BackendRequest mine = request;
    mine.split = &part;
    mine.part = BackendPart::frame;
    auto code = code_of(mine, cache);
    if (!code) return std::nullopt;
    return std::move(code->code);
  };
  return std::make_unique<const FrameCode>(*request.split, compile, at_once);
}

}  // namespace

std::expected<std::unique_ptr<Kernel>, std::string> make_first_kernel(
    const passes::SplitModule& split, const CodegenOptions& options, CodegenStats* stats) {
  const auto start = std::chrono::steady_clock::now();
  const auto request = make_request(split, options);
  if (!request) return std::unexpected(request.error());
  auto kernel =
      first_kernel(split, frame_code(*request, KernelCache(options.cache), options.compile_frame));
  if (kernel && stats) {
    stats->seconds = seconds_since(start);
    stats->first_tier = true;
    stats->width = (*kernel)->width();
    stats->cpu = request->target->name;
  }
  return kernel;
}

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
  auto made = code_of(*request, cache, options.only_cached);
  if (!made) return std::unexpected(made.error());

  std::unique_ptr<Kernel> kernel =
      CompiledKernel::make(split, std::move(made->code), request->width,
                           frame_code(*request, cache, options.compile_frame));
  if (!kernel) return std::unexpected(std::string("the compiled code cannot be loaded"));
  if (stats) {
    stats->seconds = seconds_since(start);
    stats->behind = made->behind;
    stats->from_cache = made->from_cache;
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
  request->part = BackendPart::both;
  return run_backend(*request);
}

}  // namespace pse
