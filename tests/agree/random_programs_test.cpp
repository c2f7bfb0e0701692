// The compiler's promise: interpreter and kernels give the same bits at every width, NaN and
// infinity included. Held on random programs: each runs in the interpreter without any pass, and
// compiled after all passes. Every tenth program is large and runs at every width; the small ones
// between take the widths in turn, so that each width sees thousands. Each compiled program runs a
// second time by the executor, with thread counts, tile sizes and orders of tiles in turn.
// PSE_RANDOM_PROGRAMS sets how many (default 10000); PSE_RANDOM_FIRST the first seed.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "ir/verifier.h"
#include "stream/program.h"
#include "support/agreement.h"
#include "support/random_program.h"

namespace pse::test {
namespace {

// `apart`: every call becomes a function again, which only large programs see otherwise.
std::shared_ptr<const Program> build(const std::string& text, bool optimize, bool apart,
                                     std::string& problem) {
  CompileOptions options;
  if (apart) {
    options.outline = {
        .min_total = 0, .min_size = 1, .min_saved = 1, .max_function = 0, .min_cut = 1};
  }
  std::string complaint;
  options.after_pass = [&](std::string_view pass, const ir::Module& module) {
    if (pass != "outline" || !complaint.empty()) return;
    const auto complaints = ir::verify(module);
    if (!complaints.empty()) complaint = complaints.front();
  };
  options.interpret = true;
  options.optimize = optimize;
  const RandomProgramOptions defaults;
  for (const auto& [name, components] : defaults.sample_inputs)
    options.lower.stream.push_back({name, components, ir::Rate::sample});
  for (const auto& [name, components] : defaults.frame_inputs)
    options.lower.stream.push_back({name, components, ir::Rate::frame});
  SourceMap sources;
  Diagnostics diagnostics;
  auto program =
      compile(sources, sources.add("random.pse", text), LowerHost{}, options, diagnostics);
  if (!program) problem = print_text(diagnostics, sources, false);
  if (!complaint.empty()) problem = complaint;
  return complaint.empty() ? program : nullptr;
}

AgreementResult run(const Kernel& kernel, const ir::Module& module, std::uint64_t seed) {
  RunStatus status;
  return run_kernel(kernel, module, seed, status);
}

// The compiled program on some number of threads, in tiles of some size: the same for the same
// seed.
std::string check_tiles(const Program& program, std::unique_ptr<Kernel> kernel,
                        const AgreementResult& expected, std::uint64_t seed, std::size_t w) {
  Program compiled = program;
  compiled.kernel = std::move(kernel);
  static constexpr int tile_widths[] = {1, 5, agreement_width}, tile_heights[] = {2, 1, 3, 64};
  const std::uint64_t turn = seed / 4 + w;
  const ExecuteOptions how{.tile_width = tile_widths[turn % 3],
                           .tile_height = tile_heights[turn % 4],
                           .threads = static_cast<int>(turn % 5) + 1,
                           .ordered_sink = turn % 2 == 0};
  RunStatus status;
  const std::string d = difference(expected, run_tiles(compiled, seed, how, status));
  if (d.empty()) return d;
  return "tiles of " + std::to_string(how.tile_width) + "x" + std::to_string(how.tile_height) +
         " on " + std::to_string(how.threads) + " threads differ: " + d;
}

std::string check_program(std::uint64_t seed) {
  const bool large = seed % 10 == 0;
  RandomProgramOptions shape;
  shape.statements = large ? 8 : 3;
  const std::string text = RandomProgram(seed, shape).text();
  std::string problem;
  const auto fail = [&](const std::string& what) {
    return "seed " + std::to_string(seed) + ": " + what + "\n" + text;
  };
  const auto plain = build(text, false, false, problem);
  const auto optimised = plain ? build(text, true, seed % 2 == 0, problem) : nullptr;
  if (!plain || !optimised) return fail("does not compile: " + problem);
  const AgreementResult expected = run(*plain->kernel, plain->module(), seed);
  if (const std::string d =
          difference(expected, run(*optimised->kernel, optimised->module(), seed));
      !d.empty())
    return fail("the passes change it: " + d);
  if (const auto first = make_first_kernel(*optimised->split, {}))
    if (const std::string d = difference(expected, run(**first, optimised->module(), seed));
        !d.empty())
      return fail("the first tier differs: " + d);
  static constexpr int widths[] = {16, 8, 4, 1};
  for (std::size_t w = 0; w < std::size(widths); ++w) {
    if (!large && seed % std::size(widths) != w) continue;
    const int width = widths[w];
    const CodegenOptions options{
        .width = width,
        .cpu = {},
        .optimize = seed % 8 < 4,
        .compile_frame = seed % 3 != 0,  // else interpreted, as short frames are
        .cache = {}};
    auto kernel = compile_kernel(*optimised->split, options);
    if (!kernel) return fail(kernel.error());
    const std::string at_width = "width " + std::to_string(width);
    if (const std::string d = difference(expected, run(**kernel, optimised->module(), seed));
        !d.empty())
      return fail(at_width + " differs: " + d);
    if (const std::string d = check_tiles(*optimised, std::move(*kernel), expected, seed, w);
        !d.empty())
      return fail(at_width + ", " + d);
  }
  return {};
}

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

TEST(Agree, RandomPrograms) {
  const std::uint64_t first = setting("PSE_RANDOM_FIRST", 1),
                      count = setting("PSE_RANDOM_PROGRAMS", 10000);
  std::atomic<std::uint64_t> next{first};
  std::mutex mutex;
  std::vector<std::string> failures;
  const auto work = [&] {
    for (std::uint64_t seed; (seed = next++) < first + count;) {
      std::string failure = check_program(seed);
      if (failure.empty()) continue;
      const std::scoped_lock lock(mutex);
      failures.push_back(std::move(failure));
      if (failures.size() >= 5) next = first + count;
    }
  };
  {
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
      threads.emplace_back(work);
  }
  for (const std::string& failure : failures) ADD_FAILURE() << failure;
}

}  // namespace
}  // namespace pse::test
