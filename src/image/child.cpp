// Running a program; see child.h.
#include "image/child.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace pse::image {

Result<Child> Child::start(const std::vector<std::string>& words) {
  // Its input is a socket, because writing to one can fail without a signal.
  Child child;
  std::array<int, 2> ends = {-1, -1}, started = {-1, -1};
  child.said_ = ::memfd_create("pse-child", MFD_CLOEXEC);
  if (child.said_ < 0 || ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return fail(ErrorKind::cannot_write,
                std::string("cannot start ") + words[0] + ": " + std::strerror(errno));
  child.input_ = ends[0];
  if (::pipe2(started.data(), O_CLOEXEC) != 0) {
    ::close(ends[1]);
    return fail(ErrorKind::cannot_write,
                std::string("cannot start ") + words[0] + ": " + std::strerror(errno));
  }
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  child.id_ = ::fork();
  if (child.id_ == 0) {
    // Only calls that are safe after a fork, up to exec; its failure comes back through the second
    // pipe.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::dup2(ends[1], STDIN_FILENO);
    ::dup2(child.said_, STDOUT_FILENO);
    ::dup2(child.said_, STDERR_FILENO);
    ::execvp(arguments[0], arguments.data());
    const int code = errno;
    [[maybe_unused]] const auto put = ::write(started[1], &code, sizeof code);
    ::_exit(127);
  }
  const int fork_problem = errno;
  ::close(ends[1]);
  ::close(started[1]);
  int code = 0;
  if (child.id_ < 0) {
    code = fork_problem;
  } else {
    ssize_t got = 0;
    while ((got = ::read(started[0], &code, sizeof code)) < 0 && errno == EINTR) {
    }
    if (got != sizeof code) code = 0;
  }
  ::close(started[0]);
  if (code == 0) return child;
  if (child.id_ > 0) ::waitpid(std::exchange(child.id_, -1), nullptr, 0);
  if (code == ENOENT)
    return fail(ErrorKind::cannot_write,
                "the program " + words[0] + " is not installed or not on the PATH");
  return fail(ErrorKind::cannot_write,
              std::string("cannot start ") + words[0] + ": " + std::strerror(code));
}

Child::Child(Child&& other) noexcept
    : id_(std::exchange(other.id_, -1)),
      input_(std::exchange(other.input_, -1)),
      said_(std::exchange(other.said_, -1)) {}

Child::~Child() {
  if (id_ > 0) {
    ::kill(id_, SIGKILL);
    while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (input_ >= 0) ::close(input_);
  if (said_ >= 0) ::close(said_);
}

bool Child::feed(std::span<const unsigned char> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::send(input_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    done += static_cast<std::size_t>(put);
  }
  return true;
}

bool Child::finish() {
  if (input_ >= 0) ::close(std::exchange(input_, -1));
  if (id_ <= 0) return false;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(id_, &status, 0)) < 0 && errno == EINTR) {
  }
  id_ = -1;
  return ended > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string Child::complaint() const {
  std::array<char, 2048> text{};
  const off_t end = ::lseek(said_, 0, SEEK_END);
  const off_t begin = end > 1000 ? end - 1000 : 0;
  const ssize_t got = ::pread(said_, text.data(), text.size(), begin);
  std::string said(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
  while (said.ends_with('\n')) said.pop_back();
  const auto line = said.rfind('\n');
  return line == std::string::npos ? said : said.substr(line + 1);
}

}  // namespace pse::image
