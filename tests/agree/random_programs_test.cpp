// The compiler's promise: interpreter and kernels give the same bits at every width, NaN and infinity included. Held on
// random programs: each runs in the interpreter without any pass, and compiled after all passes. Every tenth program is
// large and runs at every width; the small ones between take the widths in turn, so that each width sees thousands.
// PSE_RANDOM_PROGRAMS sets how many (default 10000); PSE_RANDOM_FIRST the first seed.
#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <thread>

#include "ir/verifier.h"
#include "stream/program.h"
#include "support/random_program.h"

namespace pse::test {
namespace {

constexpr std::int64_t samples = 37;  // more than two of the widest vectors, and a rest
constexpr std::size_t padded = 48;

// What the stream brings: plain coordinates at first, then edges of the number line.
float input_value(std::uint64_t seed, std::size_t input, std::size_t sample) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + input * 0xbf58476d1ce4e5b9u + sample * 0x94d049bb133111ebu;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  static constexpr float edges[] = {0.0f, -0.0f, 1.0f, -1.0f, std::numeric_limits<float>::infinity(),
                                    -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
                                    std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::max(),
                                    16777217.0f, 255.5f, -3.0f};
  if (sample % 5 == 4) return edges[z % std::size(edges)];
  return static_cast<float>(static_cast<double>(z >> 40) / (1 << 24) * 4 - 2);
}

struct Result {
  std::vector<std::vector<float>> outputs;
  bool failed = false;
};

Result run(const Kernel& kernel, const ir::Module& module, std::uint64_t seed) {
  Result result;
  FrameState state;
  std::vector<std::vector<float>> inputs(module.inputs.size());
  std::vector<const float*> in;
  std::vector<float*> out;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    // Values go by name, so that every build of a program gets the same.
    const std::size_t name = std::hash<std::string>{}(module.inputs[i].name);
    state.uniforms.push_back(input_value(seed, name, 0));
    for (std::size_t s = 0; s < padded; ++s) inputs[i].push_back(input_value(seed, name, s));
    in.push_back(module.inputs[i].rate == ir::Rate::sample ? inputs[i].data() : nullptr);
  }
  for (std::size_t o = 0; o < module.outputs.size(); ++o) result.outputs.emplace_back(padded, 0.0f);
  for (auto& plane : result.outputs) out.push_back(plane.data());
  RunStatus status;
  Scratch scratch;
  kernel.run_frame(state, status);
  if (status.failed_check < 0) kernel.run_samples(state, status, scratch, in.data(), out.data(), samples);
  result.failed = status.failed_check >= 0;
  return result;
}

// `apart`: every call becomes a function again, which only large programs see otherwise.
std::shared_ptr<const Program> build(const std::string& text, bool optimize, bool apart, std::string& problem) {
  CompileOptions options;
  if (apart) {
    options.outline = {.min_total = 0, .min_size = 1, .min_saved = 1, .max_function = 0, .min_cut = 1};
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
  auto program = compile(sources, sources.add("random.pse", text), LowerHost{}, options, diagnostics);
  if (!program) problem = print_text(diagnostics, sources, false);
  if (!complaint.empty()) problem = complaint;
  return complaint.empty() ? program : nullptr;
}

// The first difference between two runs, or nothing.
std::string difference(const Result& expected, const Result& got) {
  if (expected.failed != got.failed) return expected.failed ? "a check should have failed" : "a check failed";
  if (expected.failed) return {};
  for (std::size_t o = 0; o < expected.outputs.size(); ++o)
    for (std::size_t s = 0; s < samples; ++s) {
      const float a = expected.outputs[o][s], b = got.outputs[o][s];
      if (std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b))
        return "output " + std::to_string(o) + ", sample " + std::to_string(s) + ": " + std::to_string(b) +
               " instead of " + std::to_string(a);
    }
  return {};
}

std::string check_program(std::uint64_t seed) {
  const bool large = seed % 10 == 0;
  RandomProgramOptions shape;
  shape.statements = large ? 8 : 3;
  const std::string text = RandomProgram(seed, shape).text();
  std::string problem;
  const auto fail = [&](const std::string& what) { return "seed " + std::to_string(seed) + ": " + what + "\n" + text; };
  const auto plain = build(text, false, false, problem);
  const auto optimised = plain ? build(text, true, seed % 2 == 0, problem) : nullptr;
  if (!plain || !optimised) return fail("does not compile: " + problem);
  const Result expected = run(*plain->kernel, plain->module(), seed);
  if (const std::string d = difference(expected, run(*optimised->kernel, optimised->module(), seed)); !d.empty())
    return fail("the passes change it: " + d);
  static constexpr int widths[] = {16, 8, 4, 1};
  for (std::size_t w = 0; w < std::size(widths); ++w) {
    if (!large && seed % std::size(widths) != w) continue;
    const int width = widths[w];
    const CodegenOptions options{.width = width,
                                 .cpu = {},
                                 .optimize = seed % 8 < 4,
                                 .compile_frame = seed % 3 != 0,  // else interpreted, as short frames are
                                 .cache = {}};
    const auto kernel = compile_kernel(*optimised->split, options);
    if (!kernel) return fail(kernel.error());
    if (const std::string d = difference(expected, run(**kernel, optimised->module(), seed)); !d.empty())
      return fail("width " + std::to_string(width) + " differs: " + d);
  }
  return {};
}

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

TEST(Agree, RandomPrograms) {
  const std::uint64_t first = setting("PSE_RANDOM_FIRST", 1), count = setting("PSE_RANDOM_PROGRAMS", 10000);
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
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  }
  for (const std::string& failure : failures) ADD_FAILURE() << failure;
}

}  // namespace
}  // namespace pse::test
