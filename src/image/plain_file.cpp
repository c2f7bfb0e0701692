// Calls of the system; see plain_file.h.
#include "image/plain_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace pse::image {

std::string temporary_folder() {
  const char* chosen = std::getenv("TMPDIR");
  return chosen != nullptr && *chosen != '\0' ? chosen : "/tmp";
}

int nameless_file() {
  const std::string folder = temporary_folder();
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  // Not every file system has them.
  std::string pattern = folder + "/pse-XXXXXX";
  const int named = ::mkostemp(pattern.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(pattern.c_str());
  return named;
}

bool write_all(int file, const void* from, std::size_t count) {
  const char* next = static_cast<const char*>(from);
  while (count > 0) {
    const ssize_t put = ::write(file, next, count);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return false;
    next += put;
    count -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace pse::image
