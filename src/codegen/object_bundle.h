// Several objects as one string of bytes: what a kernel's code is made of, as the cache keeps it.
// Between compile.cpp and code_object.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace pse {

// Each object behind its length, 8 bytes.
inline std::string bundle(std::span<const std::string> objects) {
  std::string bytes;
  for (const std::string& object : objects) {
    const std::uint64_t size = object.size();
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes += object;
  }
  return bytes;
}

// The objects, as views into `bytes`; none where the lengths do not fit.
inline std::vector<std::span<const std::byte>> unbundle(std::string_view bytes) {
  std::vector<std::span<const std::byte>> objects;
  while (!bytes.empty()) {
    std::uint64_t size = 0;
    if (bytes.size() < sizeof size) return {};
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    if (size > bytes.size()) return {};
    objects.push_back(std::as_bytes(std::span(bytes.substr(0, size))));
    bytes.remove_prefix(size);
  }
  return objects;
}

}  // namespace pse
