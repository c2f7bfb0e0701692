// Sets of samples, and who takes which.
#include "antialias/patterns.h"

#include <algorithm>

#include "antialias/spread.h"

namespace pse::antialias {
namespace {

constexpr std::uint32_t sets = 16;  // a power of 2
constexpr std::size_t at_first = 16;
constexpr std::size_t beyond = 3;  // offsets are read four at a time

}  // namespace

Patterns::Patterns(const Filter& filter, std::uint32_t samples)
    : filter_(filter), samples_(samples), x_(sets * samples_ + beyond), y_(x_.size()) {
  make(0, 0, samples_);
  for (std::uint32_t set = 1; set < sets; ++set) make(set, 0, std::min(samples_, at_first));
}

void Patterns::make(std::uint32_t set, std::size_t first, std::size_t last) const {
  const Spread spread(static_cast<std::int32_t>(set), 0);
  for (std::size_t k = first; k < last; ++k) {
    const auto [u, v] = spread(static_cast<std::uint32_t>(k));
    const auto [x, y] = filter_.place(u, v);
    x_[set * samples_ + k] = x, y_[set * samples_ + k] = y;
  }
}

Offsets Patterns::of(std::int32_t x, std::int32_t y, std::size_t count) const {
  if (count > at_first)
    std::call_once(later_, [&] {
      for (std::uint32_t set = 1; set < sets; ++set) make(set, at_first, samples_);
    });
  const num::Int column = num::scatter<num::Int>(num::Int(x));
  const std::uint32_t set = num::scatter<num::Int>(column ^ num::Int(y)).bits() & (sets - 1);
  return Offsets{x_, y_}.part(set * samples_, count);
}

}  // namespace pse::antialias
