// Sets of samples, and who takes which.
#include "antialias/patterns.h"

#include "antialias/spread.h"

namespace pse::antialias {
namespace {

constexpr std::uint32_t sets = 16;  // a power of 2
constexpr std::size_t beyond = 3;    // offsets are read four at a time

}  // namespace

Patterns::Patterns(const Filter& filter, std::uint32_t samples) : samples_(samples) {
  for (std::uint32_t set = 0; set < sets; ++set) {
    const Spread spread(static_cast<std::int32_t>(set), 0);
    for (std::uint32_t k = 0; k < samples; ++k) {
      const auto [u, v] = spread(k);
      const auto [x, y] = filter.place(u, v);
      x_.push_back(x), y_.push_back(y);
    }
  }
  x_.resize(x_.size() + beyond), y_.resize(y_.size() + beyond);
}

Offsets Patterns::of(std::int32_t x, std::int32_t y) const {
  const num::Int column = num::scatter<num::Int>(num::Int(x));
  const std::uint32_t set = num::scatter<num::Int>(column ^ num::Int(y)).bits() & (sets - 1);
  return Offsets{x_, y_}.part(set * samples_, samples_);
}

}  // namespace pse::antialias
