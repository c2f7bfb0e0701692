// Files that appear whole or not at all; see output_file.h. The temporary is an unnamed file
// (O_TMPFILE) where the file system has them, so that even a killed process leaves nothing behind.
#include "image/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "image/plain_file.h"

namespace pse::image {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 18;

// replaces: a file would have been put in another's place; devices and pipes keep nothing.
ImageError write_error(const std::string& name, int code, bool replaces) {
  const bool full = code == ENOSPC || code == EDQUOT || code == EFBIG;
  if (full)
    return {ErrorKind::disk_full,
            "no room to write " + name + " (" + std::strerror(code) + ")" +
                (replaces ? "; what was there before is unchanged" : "")};
  return {ErrorKind::cannot_write, "cannot write " + name + ": " + std::strerror(code)};
}

// The folder part of a path, "." when there is none.
std::string folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// A name beside `target` that no other writer uses.
std::string temporary_name(const std::string& target) {
  static std::atomic<unsigned> counter{0};
  const std::string base = std::filesystem::path(target).filename().string();
  return folder_of(target) + "/." + base.substr(0, 200) + "." + std::to_string(::getpid()) + "-" +
         std::to_string(counter.fetch_add(1)) + ".part";
}

}  // namespace

Result<OutputFile> OutputFile::create(const std::string& path, bool sync) {
  OutputFile out;
  out.sync_ = sync;
  out.name_ = path == "-" ? "standard output" : path;
  if (path.empty() || path.find('\0') != std::string::npos)
    return fail(ErrorKind::cannot_write, "the output's file name is empty or holds a NUL byte");

  // Find out what stands at the target: nothing, a file to replace, or a device that takes the
  // content at the end.
  if (path == "-") {
    out.device_ = ::dup(STDOUT_FILENO);
    if (out.device_ < 0) return std::unexpected(write_error(out.name_, errno, false));
  } else {
    out.target_ = path;
    if (char* real = ::realpath(path.c_str(), nullptr)) {
      out.target_ = real;
      std::free(real);
    }
    struct stat about {};
    if (::stat(out.target_.c_str(), &about) == 0) {
      if (S_ISDIR(about.st_mode))
        return fail(ErrorKind::cannot_write, "cannot write " + path + ": it is a folder");
      if (::access(out.target_.c_str(), W_OK) != 0)
        return std::unexpected(write_error(path, errno, false));
      if (S_ISREG(about.st_mode)) {
        out.mode_ = about.st_mode & 07777u;
      } else {
        out.device_ = ::open(out.target_.c_str(), O_WRONLY | O_CLOEXEC);
        if (out.device_ < 0) return std::unexpected(write_error(path, errno, false));
        out.target_.clear();
      }
    }
  }

  // Open the temporary: without a name where that is possible, else under a name of its own.
  const std::string folder = out.target_.empty() ? temporary_folder() : folder_of(out.target_);
  if (out.target_.empty()) {
    out.file_ = nameless_file();
  } else {
    out.file_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (out.file_ < 0) {
      out.temporary_ = temporary_name(out.target_);
      out.file_ = ::open(out.temporary_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
      if (out.file_ < 0) out.temporary_.clear();
    }
  }
  if (out.file_ < 0) {
    const int code = errno;
    std::error_code none;
    if (code == ENOENT || code == ENOTDIR)
      return fail(ErrorKind::cannot_write,
                  "cannot write " + path + ": the folder " + folder +
                      (std::filesystem::is_directory(folder, none) ? " takes no files"
                                                                   : " does not exist"));
    return std::unexpected(write_error(out.name_, code, !out.target_.empty()));
  }
  out.buffer_.reserve(buffer_bytes);
  return out;
}

OutputFile::OutputFile(OutputFile&& other) noexcept { *this = std::move(other); }

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this == &other) return *this;
  discard();
  name_ = std::move(other.name_);
  target_ = std::move(other.target_);
  temporary_ = std::exchange(other.temporary_, {});
  file_ = std::exchange(other.file_, -1);
  device_ = std::exchange(other.device_, -1);
  sync_ = other.sync_;
  mode_ = other.mode_;
  errno_ = other.errno_;
  position_ = other.position_;
  buffer_ = std::move(other.buffer_);
  return *this;
}

OutputFile::~OutputFile() { discard(); }

void OutputFile::discard() {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  if (device_ >= 0) ::close(std::exchange(device_, -1));
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

ImageError OutputFile::error() const {
  return write_error(name_, errno_ == 0 ? EIO : errno_, !target_.empty());
}

bool OutputFile::flush() {
  if (errno_ != 0) return false;
  if (!write_all(file_, buffer_.data(), buffer_.size())) {
    errno_ = errno;
    return false;
  }
  position_ += buffer_.size();
  buffer_.clear();
  return true;
}

bool OutputFile::write(const void* from, std::size_t count) {
  if (errno_ != 0) return false;
  if (buffer_.size() + count > buffer_bytes && !flush()) return false;
  const char* bytes = static_cast<const char*>(from);
  if (count < buffer_bytes) {
    buffer_.insert(buffer_.end(), bytes, bytes + count);
    return true;
  }
  if (!write_all(file_, bytes, count)) {
    errno_ = errno;
    return false;
  }
  position_ += count;
  return true;
}

bool OutputFile::seek(std::uint64_t position) {
  if (!flush()) return false;
  if (::lseek(file_, static_cast<off_t>(position), SEEK_SET) < 0) {
    errno_ = errno;
    return false;
  }
  position_ = position;
  return true;
}

// Appends the whole temporary to another file.
bool OutputFile::copy_to(int target) {
  if (::lseek(file_, 0, SEEK_SET) < 0) return false;
  std::vector<char> block(buffer_bytes);
  for (;;) {
    const ssize_t got = ::read(file_, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) return true;
    if (!write_all(target, block.data(), static_cast<std::size_t>(got))) return false;
  }
}

std::string OutputFile::path_for_others() const {
  return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file_);
}

Result<void> OutputFile::commit() {
  const auto refuse = [&](int code) -> Result<void> {
    errno_ = code;
    discard();
    return std::unexpected(error());
  };
  if (!flush()) return refuse(errno_);

  // A device or a pipe gets the content now.
  if (target_.empty()) {
    if (!copy_to(device_)) return refuse(errno);
    const int device = std::exchange(device_, -1);
    if (::close(device) != 0 && errno != EINTR) return refuse(errno);
    discard();
    return {};
  }

  // Let the content reach the disk, while it has no name that could remain.
  const auto reached_disk = [&] { return !sync_ || ::fsync(file_) == 0 || errno == EINVAL; };
  if (mode_ != 0 && ::fchmod(file_, mode_) != 0) return refuse(errno);
  if (!reached_disk()) return refuse(errno);

  // Give the temporary a name. Where an unnamed file cannot get one, copy it to a file that has
  // one.
  if (temporary_.empty()) {
    const std::string name = temporary_name(target_);
    const std::string self = "/proc/self/fd/" + std::to_string(file_);
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      temporary_ = name;
    } else {
      const int named = ::open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
      if (named < 0) return refuse(errno);
      temporary_ = name;
      const bool copied = copy_to(named);
      const int code = errno;
      ::close(std::exchange(file_, named));
      if (!copied) return refuse(code);
      if (mode_ != 0 && ::fchmod(file_, mode_) != 0) return refuse(errno);
      if (!reached_disk()) return refuse(errno);
    }
  }

  // Take the target's place.
  const int file = std::exchange(file_, -1);
  if (::close(file) != 0 && errno != EINTR) return refuse(errno);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return refuse(errno);
  temporary_.clear();
  return {};
}

}  // namespace pse::image
