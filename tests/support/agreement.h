// One program run in several ways on the same samples, and whether the bits are the same: what the
// random programs of tests/agree and the fuzz target of the compiler have in common. The samples
// take plain coordinates and edges of the number line.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "stream/executor.h"
#include "stream/program.h"

namespace pse::test {

// A little picture: more than two of the widest vectors in use, and a rest.
constexpr int agreement_width = 13, agreement_height = 3;
constexpr std::int64_t agreement_samples = agreement_width * agreement_height;
constexpr std::size_t agreement_padded = 48;

// What the stream brings: plain coordinates at first, then edges of the number line.
inline float input_value(std::uint64_t seed, std::size_t input, std::size_t sample) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + input * 0xbf58476d1ce4e5b9u +
                    sample * 0x94d049bb133111ebu;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  constexpr float inf = std::numeric_limits<float>::infinity();
  static constexpr float edges[] = {0.0f,
                                    -0.0f,
                                    1.0f,
                                    -1.0f,
                                    inf,
                                    -inf,
                                    std::numeric_limits<float>::quiet_NaN(),
                                    std::numeric_limits<float>::denorm_min(),
                                    std::numeric_limits<float>::max(),
                                    16777217.0f,
                                    255.5f,
                                    -3.0f};
  if (sample % 5 == 4) return edges[z % std::size(edges)];
  return static_cast<float>(static_cast<double>(z >> 40) / (1 << 24) * 4 - 2);
}

// By name, so that every build of a program gets the same, whatever it still reads.
inline std::size_t salt_of(const ir::Input& input) { return std::hash<std::string>{}(input.name); }

struct AgreementResult {
  std::vector<std::vector<float>> outputs;  // each agreement_samples long, and some
  bool failed = false;                      // a check
};

inline FrameState agreement_state(const ir::Module& module, std::uint64_t seed) {
  FrameState state;
  for (const ir::Input& input : module.inputs)
    state.uniforms.push_back(input_value(seed, salt_of(input), 0));
  return state;
}

// The kernel on all samples at once.
inline AgreementResult run_kernel(const Kernel& kernel, const ir::Module& module,
                                  std::uint64_t seed, RunStatus& status) {
  AgreementResult result;
  FrameState state = agreement_state(module, seed);
  std::vector<std::vector<float>> inputs(module.inputs.size());
  std::vector<const float*> in;
  std::vector<float*> out;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    for (std::size_t s = 0; s < agreement_padded; ++s)
      inputs[i].push_back(input_value(seed, salt_of(module.inputs[i]), s));
    in.push_back(module.inputs[i].rate == ir::Rate::sample ? inputs[i].data() : nullptr);
  }
  result.outputs.assign(module.outputs.size(), std::vector<float>(agreement_padded, 0.0f));
  for (auto& plane : result.outputs) out.push_back(plane.data());
  Scratch scratch;
  kernel.run_frame(state, status);
  if (status.failed_check < 0)
    kernel.run_samples(state, status, scratch, in.data(), out.data(), agreement_samples);
  result.failed = status.failed_check >= 0;
  return result;
}

// The kernel by the executor, in tiles on threads.
inline AgreementResult run_tiles(const Program& program, std::uint64_t seed,
                                 const ExecuteOptions& how, RunStatus& status) {
  const ir::Module& module = program.module();
  AgreementResult result;
  result.outputs.assign(module.outputs.size(), std::vector<float>(agreement_padded, 0.0f));
  FrameState state = agreement_state(module, seed);
  const auto each = [](const TileView& tile, const auto& visit) {
    for (std::int64_t i = 0; i < tile.count; ++i) {
      const std::int64_t x = tile.rect.x0 + i % tile.rect.width();
      const std::int64_t y = tile.rect.y0 + i / tile.rect.width();
      visit(static_cast<std::size_t>(i), static_cast<std::size_t>(y * agreement_width + x));
    }
  };
  const auto source = [&](const TileView& tile) {
    for (std::size_t p = 0; p < tile.planes.size(); ++p)
      if (tile.planes[p] != nullptr)
        each(tile, [&](std::size_t i, std::size_t sample) {
          tile.planes[p][i] = input_value(seed, salt_of(module.inputs[p]), sample);
        });
  };
  const auto sink = [&](const TileView& tile) {
    for (std::size_t o = 0; o < tile.planes.size(); ++o)
      each(tile, [&](std::size_t i, std::size_t sample) {
        result.outputs[o][sample] = tile.planes[o][i];
      });
  };
  ExecuteOptions options = how;
  options.window = {0, 0, agreement_width, agreement_height};
  result.failed = execute(program, state, source, sink, options, status).end == RunEnd::failed;
  return result;
}

// The first difference between two runs, or nothing.
inline std::string difference(const AgreementResult& expected, const AgreementResult& got) {
  if (expected.failed != got.failed)
    return expected.failed ? "a check should have failed" : "a check failed";
  if (expected.failed) return {};
  for (std::size_t o = 0; o < expected.outputs.size(); ++o)
    for (std::size_t s = 0; s < agreement_samples; ++s) {
      const float a = expected.outputs[o][s], b = got.outputs[o][s];
      if (std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b))
        return "output " + std::to_string(o) + ", sample " + std::to_string(s) + ": " +
               std::to_string(b) + " instead of " + std::to_string(a);
    }
  return {};
}

}  // namespace pse::test
