// Calls of the host's functions from within conditionals and loops: the active lanes are moved
// together, so that the host is asked for no others (a ray or a lookup costs more than the moving).
#include <array>
#include <bit>

#include "codegen/kernel_call.h"

namespace pse {

void call_active(void (*call)(void*, std::int64_t, const float* const*, float* const*), void* user,
                 std::uint64_t active, std::int64_t lanes, std::int64_t arguments,
                 const float* const* argument, std::int64_t results, float* const* result) {
  constexpr std::size_t most = 64, rows = 64;
  const auto given = static_cast<std::size_t>(arguments), got = static_cast<std::size_t>(results);
  const bool all = std::popcount(active) == lanes;
  if (all || given + got > rows) return call(user, lanes, argument, result);

  // Which lanes.
  std::array<std::size_t, most> lane;
  std::size_t count = 0;
  for (std::uint64_t rest = active; rest != 0; rest &= rest - 1)
    lane[count++] = static_cast<std::size_t>(std::countr_zero(rest));

  // Moved together, called, and put back.
  alignas(64) std::array<std::array<float, most>, rows> values;
  std::array<const float*, rows> in;
  std::array<float*, rows> out;
  for (std::size_t a = 0; a < given; ++a) {
    for (std::size_t i = 0; i < count; ++i) values[a][i] = argument[a][lane[i]];
    in[a] = values[a].data();
  }
  for (std::size_t r = 0; r < got; ++r) out[r] = values[given + r].data();
  if (count > 0) call(user, static_cast<std::int64_t>(count), in.data(), out.data());
  for (std::size_t r = 0; r < got; ++r) {
    std::fill_n(result[r], lanes, 0.0f);
    for (std::size_t i = 0; i < count; ++i) result[r][lane[i]] = out[r][i];
  }
}

}  // namespace pse
