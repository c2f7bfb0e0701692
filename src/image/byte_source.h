// Where a reader gets its bytes: a file, or memory. Standard input and pipes are spooled there, and
// where they bring much to a file without a name in $TMPDIR.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "image/error.h"

namespace pse::image {

// Bytes at random positions. read_at is safe to call from several threads.
class ByteSource {
 public:
  explicit ByteSource(std::string shown) : name_(std::move(shown)) {}
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  const std::string& name() const { return name_; }  // as messages show it
  virtual std::uint64_t size() const = 0;
  // Whether name() is the path of a plain file that others can open too.
  virtual bool is_file() const { return false; }
  // Copies up to `count` bytes from `offset` on and returns how many; fewer at the end, -1 on an
  // I/O error.
  virtual std::int64_t read_at(std::uint64_t offset, void* to, std::size_t count) const = 0;

 private:
  std::string name_;
};

using Bytes = std::shared_ptr<const ByteSource>;

// Opens a file; "-" is standard input. What cannot seek is read whole, at most `max_spool` bytes of
// it.
Result<Bytes> open_bytes(const std::string& path, std::uint64_t max_spool);
Bytes bytes_from_memory(std::string name, std::vector<unsigned char> content);

}  // namespace pse::image
