// A 128-bit hash of content: names of cached files, sameness of recipes. Not cryptographic.
// Used wherever something is kept by what it was made from.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace pse {

struct Hash128 {
  std::uint64_t high = 0, low = 0;
  friend bool operator==(const Hash128&, const Hash128&) = default;

  // 32 lower-case hexadecimal digits.
  std::string text() const {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string result;
    for (const std::uint64_t word : {high, low}) {
      for (int shift = 60; shift >= 0; shift -= 4) result += digits[(word >> shift) & 15];
    }
    return result;
  }
};

// Takes content in pieces. Two words of state, each mixed with every word of content by a
// multiplication of its own and a rotation; the end is mixed until every bit of state reaches every
// bit of the result.
class Hasher {
 public:
  void add_word(std::uint64_t word) {
    a_ = (a_ ^ mix(word + 0x9e3779b97f4a7c15u)) * 0xff51afd7ed558ccdu;
    b_ = (std::rotl(b_, 29) + mix(word ^ 0xc2b2ae3d27d4eb4fu)) * 0x9fb21c651e98df25u;
    a_ ^= std::rotl(b_, 17);
    ++words_;
  }

  // The length goes in first, so that pieces do not run into each other.
  void add_bytes(std::span<const std::byte> bytes) {
    add_word(bytes.size());
    while (!bytes.empty()) {
      std::uint64_t word = 0;
      const std::size_t size = bytes.size() < 8 ? bytes.size() : 8;
      std::memcpy(&word, bytes.data(), size);
      add_word(word);
      bytes = bytes.subspan(size);
    }
  }
  void add(std::string_view text) { add_bytes(std::as_bytes(std::span(text))); }

  template <class T>
  requires std::is_integral_v<T> || std::is_enum_v<T>
  void add(T value) { add_word(static_cast<std::uint64_t>(value)); }
  void add(float value) { add_word(std::bit_cast<std::uint32_t>(value)); }

  Hash128 finish() const {
    const std::uint64_t a = mix(a_ + words_), b = mix(b_ ^ a);
    return {mix(a + std::rotl(b, 32)), b};
  }

 private:
  static std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93u;
    x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93u;
    return x ^ (x >> 32);
  }

  std::uint64_t a_ = 0x243f6a8885a308d3u, b_ = 0x13198a2e03707344u, words_ = 0;
};

}  // namespace pse
