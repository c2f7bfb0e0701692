// The layout of a batch's buffers.
#include "stream/planes.h"

#include <algorithm>
#include <memory>

namespace pse {
namespace {

constexpr std::size_t line = 16;        // floats in a cache line, and in the widest vector
constexpr std::size_t page_lines = 64;  // lines after which addresses alias
// Lines between neighbouring planes modulo a page. Any two of ten planes in a row are then 5 lines
// apart or more.
constexpr std::size_t step = 23;

// Floats from one plane to the next.
std::size_t stride(std::int64_t capacity) {
  const std::size_t lines =
      (static_cast<std::size_t>(std::max<std::int64_t>(capacity, 1)) + line - 1) / line;
  const std::size_t shift = (step + page_lines - lines % page_lines) % page_lines;
  return (lines + shift) * line;
}

// Of all planes: with room to align the first, and to read on behind the last.
std::size_t floats(std::size_t count, std::int64_t capacity) {
  return count * stride(capacity) + 2 * line;
}

}  // namespace

void Planes::arrange(const std::vector<bool>& used, std::int64_t capacity) {
  const auto count = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  if (memory_.size() < floats(count, capacity)) memory_.assign(floats(count, capacity), 0.0f);
  pointers_.clear();
  void* start = memory_.data();
  std::size_t space = memory_.size() * sizeof(float);
  auto* next = static_cast<float*>(std::align(line * sizeof(float), sizeof(float), start, space));
  for (const bool in_use : used) {
    pointers_.push_back(in_use ? next : nullptr);
    if (in_use) next += stride(capacity);
  }
}

std::size_t Planes::bytes(const std::vector<bool>& used, std::int64_t capacity) {
  const auto count = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  return floats(count, capacity) * sizeof(float);
}

}  // namespace pse
