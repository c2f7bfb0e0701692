// Files and memory as sources of bytes; see byte_source.h.
#include "image/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "image/plain_file.h"

namespace pse::image {
namespace {

class FileBytes : public ByteSource {
 public:
  // `named`: the file can be opened by that name too.
  FileBytes(std::string shown, int file, std::uint64_t bytes, bool named)
      : ByteSource(std::move(shown)), file_(file), size_(bytes), named_(named) {}
  ~FileBytes() override { ::close(file_); }

  std::uint64_t size() const override { return size_; }
  bool is_file() const override { return named_; }
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
  bool named_;
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

// Of what cannot seek this much is kept in memory, and more of it in a file without a name.
constexpr std::size_t spool_in_memory = std::size_t{32} << 20;

// Everything that `file` still yields.
Result<Bytes> spool(const std::string& shown, int file, std::uint64_t most) {
  std::vector<unsigned char> content, block(std::size_t{1} << 16);
  std::uint64_t size = 0;
  int disk = -1;
  const auto refuse = [&](ErrorKind kind, const std::string& message) {
    if (disk >= 0) ::close(disk);
    return fail(kind, message);
  };
  const auto to_disk = [&] {
    if (disk < 0) disk = nameless_file();
    const bool good = disk >= 0 && write_all(disk, content.data(), content.size());
    content.clear();
    return good;
  };
  const auto no_room = [&] {
    return refuse(ErrorKind::cannot_read, "no room to keep what " + shown + " brings (" +
                                              std::strerror(errno) + "); TMPDIR names the folder");
  };
  for (;;) {
    const ssize_t got = ::read(file, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      return refuse(ErrorKind::cannot_read, "cannot read " + shown + ": " + std::strerror(errno));
    if (got == 0) break;
    size += static_cast<std::uint64_t>(got);
    if (size > most)
      return refuse(ErrorKind::too_large, shown + " brings more than " + std::to_string(most) +
                                              " bytes; save it to a file first");
    content.insert(content.end(), block.begin(), block.begin() + got);
    if (content.size() >= spool_in_memory && !to_disk()) return no_room();
  }
  if (disk < 0) return bytes_from_memory(shown, std::move(content));
  if (!to_disk()) return no_room();
  return std::make_shared<FileBytes>(shown, disk, size, false);
}

}  // namespace

Bytes bytes_from_memory(std::string name, std::vector<unsigned char> content) {
  return std::make_shared<MemoryBytes>(std::move(name), std::move(content));
}

Result<Bytes> open_bytes(const std::string& path, std::uint64_t max_spool) {
  if (path == "-") {
    struct stat about {};
    if (::fstat(STDIN_FILENO, &about) == 0 && S_ISDIR(about.st_mode))
      return fail(ErrorKind::cannot_read, "standard input is a folder, not an image");
    if (S_ISCHR(about.st_mode) && about.st_rdev != makedev(1, 3))  // /dev/null is empty
      return fail(ErrorKind::cannot_read, "standard input is a terminal or device, not an image");
    return spool("standard input", STDIN_FILENO, max_spool);
  }
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
  if (S_ISBLK(about.st_mode) || S_ISCHR(about.st_mode)) {
    ::close(file);
    return fail(ErrorKind::cannot_read, path + " is a device, not an image");
  }
  if (!S_ISREG(about.st_mode)) {
    auto spooled = spool(path, file, max_spool);
    ::close(file);
    return spooled;
  }
  return std::make_shared<FileBytes>(path, file, static_cast<std::uint64_t>(about.st_size), true);
}

}  // namespace pse::image
