// Compiled kernels on disk, by content. Many processes may use one folder at once; a damaged entry
// counts as absent. Between compile.cpp and the file system.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/hash.h"

namespace pse {

class KernelCache {
 public:
  static constexpr std::uintmax_t default_limit = std::uintmax_t{256} << 20;

  // An empty folder name: nothing is kept.
  explicit KernelCache(std::filesystem::path folder, std::uintmax_t limit = default_limit)
      : folder_(std::move(folder)), limit_(limit) {}

  bool keeps() const { return !folder_.empty(); }
  std::optional<std::string> find(const Hash128& key) const;
  // Failure to write is no error: the next run compiles again.
  void keep(const Hash128& key, const std::string& object) const;

 private:
  std::filesystem::path path_of(const Hash128& key) const;
  void make_room() const;

  std::filesystem::path folder_;
  std::uintmax_t limit_;
};

}  // namespace pse
