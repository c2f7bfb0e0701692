// The head of a PLY file, and its numbers: for points (ply_reader.cpp) and for meshes
// (surface/ply_mesh.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "image/byte_source.h"

namespace pse::image {

enum class PlyOrder { ascii, little, big };

struct PlyType {
  int bytes = 0;
  bool real = false, with_sign = false;
};

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count;  // of a list: what its length is written as
};

struct PlyElement {
  std::string name;
  std::int64_t rows = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyOrder order = PlyOrder::ascii;
  std::vector<PlyElement> elements;  // in the order of the file
  std::uint64_t end = 0;             // where the data begin
  // Whether binary numbers are stored the other way round than this machine's.
  bool swapped() const {
    return (order == PlyOrder::big) == (std::endian::native == std::endian::little);
  }
};

Result<PlyHeader> read_ply_header(const ByteSource& bytes);

// A binary number.
inline double ply_number(const unsigned char* at, const PlyType& type, bool swap) {
  std::array<unsigned char, 8> raw{};
  const auto bytes = static_cast<std::size_t>(type.bytes);
  std::memcpy(raw.data(), at, bytes);
  if (swap) std::reverse(raw.begin(), raw.begin() + type.bytes);
  const auto bits = std::bit_cast<std::uint64_t>(raw);
  if (type.real)
    return bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                      : std::bit_cast<double>(bits);
  const int width = 8 * type.bytes;
  const bool negative = type.with_sign && (bits >> (width - 1) & 1) != 0;
  return static_cast<double>(bits) - (negative ? std::ldexp(1.0, width) : 0.0);
}

}  // namespace pse::image
