// Files and memory as sources of bytes; see byte_source.h.
#include "image/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace pse::image {
namespace {

class FileBytes : public ByteSource {
 public:
  FileBytes(std::string shown, int file, std::uint64_t bytes)
      : ByteSource(std::move(shown)), file_(file), size_(bytes) {}
  ~FileBytes() override { ::close(file_); }

  std::uint64_t size() const override { return size_; }
  bool is_file() const override { return true; }
  std::int64_t read_at(std::uint64_t offset, void* to, std::size_t count) const override {
    std::size_t done = 0;
    while (done < count) {
      const ssize_t got = ::pread(file_, static_cast<char*>(to) + done, count - done,
                                  static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return -1;
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return static_cast<std::int64_t>(done);
  }

 private:
  int file_;
  std::uint64_t size_;
};

class MemoryBytes : public ByteSource {
 public:
  MemoryBytes(std::string shown, std::vector<unsigned char> content)
      : ByteSource(std::move(shown)), content_(std::move(content)) {}

  std::uint64_t size() const override { return content_.size(); }
  std::int64_t read_at(std::uint64_t offset, void* to, std::size_t count) const override {
    if (offset >= content_.size()) return 0;
    const std::size_t n = std::min(count, content_.size() - static_cast<std::size_t>(offset));
    std::memcpy(to, content_.data() + offset, n);
    return static_cast<std::int64_t>(n);
  }

 private:
  std::vector<unsigned char> content_;
};

// Everything that `file` still yields.
Result<Bytes> spool(const std::string& shown, int file, std::uint64_t most) {
  std::vector<unsigned char> content;
  std::vector<unsigned char> block(std::size_t{1} << 16);
  for (;;) {
    const ssize_t got = ::read(file, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return fail(ErrorKind::cannot_read, "cannot read " + shown + ": " + std::strerror(errno));
    if (got == 0) break;
    if (content.size() + static_cast<std::size_t>(got) > most)
      return fail(ErrorKind::too_large, shown + " brings more than " + std::to_string(most) +
                                            " bytes; save it to a file first");
    content.insert(content.end(), block.begin(), block.begin() + got);
  }
  return bytes_from_memory(shown, std::move(content));
}

}  // namespace

Bytes bytes_from_memory(std::string name, std::vector<unsigned char> content) {
  return std::make_shared<MemoryBytes>(std::move(name), std::move(content));
}

Result<Bytes> open_bytes(const std::string& path, std::uint64_t max_spool) {
  if (path == "-") return spool("standard input", STDIN_FILENO, max_spool);
  if (path.empty() || path.find('\0') != std::string::npos)
    return fail(ErrorKind::not_found, "the file name is empty or holds a NUL byte");

  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    return fail(missing ? ErrorKind::not_found : ErrorKind::cannot_read,
                "cannot open " + path + ": " + std::strerror(errno));
  }
  struct stat about {};
  if (::fstat(file, &about) != 0 || S_ISDIR(about.st_mode)) {
    ::close(file);
    return fail(ErrorKind::cannot_read, path + " is a folder, not an image");
  }
  if (!S_ISREG(about.st_mode)) {
    auto spooled = spool(path, file, max_spool);
    ::close(file);
    return spooled;
  }
  return std::make_shared<FileBytes>(path, file, static_cast<std::uint64_t>(about.st_size));
}

}  // namespace pse::image
