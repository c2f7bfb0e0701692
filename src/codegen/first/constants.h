// The constants of a kernel: rows of eight lanes behind the code, at fixed distances from a base
// register.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "codegen/first/assembler.h"

namespace pse::first {

class Constants {
 public:
  static constexpr Gpr base = Gpr::rbp;
  using Row = std::array<std::uint32_t, 8>;

  // The same bits in all lanes.
  Memory all(std::uint32_t bits) {
    const auto [found, fresh] = places_.try_emplace(bits, size());
    if (fresh) rows_.insert(rows_.end(), 8, bits);
    return {base, found->second};
  }

  Memory row(const Row& row) {
    rows_.insert(rows_.end(), row.begin(), row.end());
    return {base, size() - 32};
  }

  Memory lane_numbers() {
    if (lane_numbers_ < 0) lane_numbers_ = row({0, 1, 2, 3, 4, 5, 6, 7}).disp;
    return {base, lane_numbers_};
  }

  // Words one after another; whole rows are taken.
  template <class T>
  Memory list(std::span<const T> words) {
    const std::int32_t start = size();
    for (const T word : words) rows_.push_back(std::bit_cast<std::uint32_t>(word));
    rows_.resize((rows_.size() + 7) / 8 * 8);
    return {base, start};
  }

  // The bits that all lanes of a row have, if it came from all().
  std::uint32_t first_of(std::int32_t row) const {
    return rows_[static_cast<std::size_t>(row) / 4];
  }

  const std::vector<std::uint32_t>& words() const { return rows_; }

 private:
  std::int32_t size() const { return static_cast<std::int32_t>(rows_.size() * 4); }

  std::vector<std::uint32_t> rows_;
  std::int32_t lane_numbers_ = -1;
  std::unordered_map<std::uint32_t, std::int32_t> places_;
};

}  // namespace pse::first
