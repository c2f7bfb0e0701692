// Copies a strip of 8 rows into the order of its blocks, runs it, and copies the results back.
#include "stream/blocks.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "stream/planes.h"

namespace pse {
namespace {

constexpr int side = 8;

// Every other bit of n: 0, 2 and 4.
constexpr int even_bits(int n) { return (n & 1) | (n >> 1 & 2) | (n >> 2 & 4); }

// Places in a strip of width x height samples (height at most 8) in the order of computing: block
// by block, each along Morton's curve, of which any 8, 16 or 32 in a row lie in 4 x 2, 4 x 4 or
// 8 x 4.
std::vector<std::int32_t> order_of(int width, int height) {
  std::vector<std::int32_t> order;
  order.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int left = 0; left < width; left += side)
    for (int n = 0; n < side * side; ++n) {
      const int x = left + even_bits(n), y = even_bits(n >> 1);
      if (x < width && y < height) order.push_back(y * width + x);
    }
  return order;
}

// The planes from sample `first` on.
template <class Pointer>
std::vector<Pointer> from(std::span<float* const> planes, std::int64_t first) {
  std::vector<Pointer> moved;
  for (float* plane : planes) moved.push_back(plane ? plane + first : nullptr);
  return moved;
}

}  // namespace

void run_tile(const Program& program, const FrameState& state, RunStatus& status, Scratch& scratch,
              std::span<float* const> inputs, std::span<float* const> outputs, int width,
              int height) {
  const Kernel& kernel = *program.kernel;
  if (!program.parts || kernel.width() == 1 || height == 1)
    return kernel.run_samples(state, status, scratch, inputs.data(), outputs.data(),
                              std::int64_t{width} * height);

  std::vector<bool> used;
  for (const float* plane : inputs) used.push_back(plane != nullptr);
  const std::vector<bool> all(outputs.size(), true);
  const std::int64_t capacity = std::int64_t{width} * std::min(side, height);
  const Planes in(used, capacity), out(all, capacity);
  std::vector<std::int32_t> order;
  for (int top = 0; top < height; top += side) {
    const int rows = std::min(side, height - top);
    const std::int64_t first = std::int64_t{top} * width, count = std::int64_t{rows} * width;
    if (order.size() != static_cast<std::size_t>(count)) order = order_of(width, rows);
    for (std::size_t p = 0; p < inputs.size(); ++p)
      if (used[p])
        std::ranges::transform(order, in.pointers()[p],
                               [from = inputs[p] + first](std::int32_t i) { return from[i]; });
    kernel.run_samples(state, status, scratch, in.pointers().data(), out.pointers().data(), count);

    // Which sample fails first is asked in the order of rows.
    if (status.failed_check >= 0) {
      status.failed_check = -1;
      kernel.run_samples(state, status, scratch, from<const float*>(inputs, first).data(),
                         from<float*>(outputs, first).data(), count);
      status.failed_sample += static_cast<std::uint32_t>(first);
    }
    if (status.failed_check >= 0 || status.stopped()) return;
    for (std::size_t p = 0; p < outputs.size(); ++p)
      for (std::size_t i = 0; i < order.size(); ++i)
        outputs[p][first + order[i]] = out.pointers()[p][i];
  }
}

}  // namespace pse
